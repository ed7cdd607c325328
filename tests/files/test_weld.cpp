#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <vector>

#include "files/weld.h"

namespace aerate {
namespace {

// The definition, by an ordered map: -0 and 0 compare equal.
Mesh weld_by_map(const std::vector<Vec3f>& corners) {
  Mesh mesh;
  std::map<std::array<float, 3>, std::uint32_t> numbers;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i % 3 == 0) mesh.triangles.emplace_back();
    const auto next = static_cast<std::uint32_t>(mesh.positions.size());
    const auto [place, is_new] = numbers.emplace(std::array{corners[i].x, corners[i].y, corners[i].z}, next);
    if (is_new) mesh.positions.push_back(corners[i]);
    mesh.triangles.back()[i % 3] = place->second;
  }
  return mesh;
}

void expect_same(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.positions.size(), b.positions.size());
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    EXPECT_EQ(a.positions[i], b.positions[i]);
    EXPECT_EQ(std::signbit(a.positions[i].x), std::signbit(b.positions[i].x));
  }
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(Weld, JoinsEqualCornersAndNumbersThemByFirstUse) {
  const std::vector<Vec3f> corners{{5, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {5, 0, 0}, {0, 0, 1}};
  const Mesh mesh = weld(corners);
  EXPECT_EQ(mesh.positions, (std::vector<Vec3f>{{5, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 0, 3}}));
}

TEST(Weld, NegativeZeroIsZeroAndTheFirstOnesBitsStay) {
  const std::vector<Vec3f> corners{{-0.0f, 0, 0}, {0, -0.0f, 1}, {1, 0, 0},
                                   {0, 0, -0.0f}, {0, 0, 1},     {1, 0, 0}};
  const Mesh mesh = weld(corners);
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_TRUE(std::signbit(mesh.positions[0].x));
  EXPECT_EQ(mesh.triangles[0], mesh.triangles[1]);
}

TEST(Weld, NeighbouringValuesStayApart) {
  const float next = std::nextafter(1.0f, 2.0f);
  const std::vector<Vec3f> corners{{1, 0, 0}, {next, 0, 0}, {1, 1, 0}};
  EXPECT_EQ(weld(corners).positions.size(), 3u);
}

TEST(Weld, AgreesWithAnOrderedMapOnCoarseAndOnAllDifferentCorners) {
  std::mt19937 random(7);
  for (const int steps : {2, 9, 1 << 20}) {
    for (const std::size_t triangles :
         {std::size_t{1}, std::size_t{5}, std::size_t{512}, std::size_t{513}, std::size_t{20000}}) {
      std::uniform_int_distribution<int> coordinate(-steps, steps);
      std::vector<Vec3f> corners(3 * triangles);
      for (Vec3f& c : corners) {
        c = {static_cast<float>(coordinate(random)), static_cast<float>(coordinate(random)) * -0.25f,
             static_cast<float>(coordinate(random)) * 1e-3f};
      }
      SCOPED_TRACE(triangles);
      expect_same(weld(corners), weld_by_map(corners));
    }
  }
}

TEST(Weld, NothingGivesAnEmptyMesh) {
  const Mesh mesh = weld({});
  EXPECT_TRUE(mesh.positions.empty());
  EXPECT_TRUE(mesh.triangles.empty());
}

}  // namespace
}  // namespace aerate
