#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "check/shell_topology.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using test::contains;

TEST(ShellTopology, SpheresAndBoxesAreSound) {
  EXPECT_EQ(flaw_of_sphere_shell(test::make_box({0, 0, 0}, {1, 1, 1}).triangles), std::nullopt);
  EXPECT_EQ(flaw_of_sphere_shell(test::make_uv_sphere(1, 10, 20).triangles), std::nullopt);
  EXPECT_EQ(flaw_of_sphere_shell(test::turned_inside_out(test::make_uv_sphere(1, 5, 7)).triangles),
            std::nullopt);
}

TEST(ShellTopology, NumbersOfVerticesMayBeginAnywhere) {
  Mesh sphere = test::make_uv_sphere(1, 6, 6);
  for (Triangle& t : sphere.triangles) t = {t[0] + 1000, t[1] + 1000, t[2] + 1000};
  EXPECT_EQ(flaw_of_sphere_shell(sphere.triangles), std::nullopt);
}

void expect_flaw(const Mesh& mesh, const std::string& said) {
  const auto flaw = flaw_of_sphere_shell(mesh.triangles);
  ASSERT_TRUE(flaw.has_value()) << "no flaw found; expected: " << said;
  EXPECT_TRUE(contains(*flaw, said));
}

TEST(ShellTopology, FindsEachFlaw) {
  const Mesh box = test::make_box({0, 0, 0}, {1, 1, 1});
  expect_flaw({}, "no triangles");

  Mesh open = box;
  open.triangles.pop_back();
  expect_flaw(open, "open");

  Mesh twisted = box;
  std::swap(twisted.triangles[0][0], twisted.triangles[0][1]);
  expect_flaw(twisted, "opposite ways");

  Mesh repeated = box;
  repeated.triangles.push_back({0, 0, 1});
  expect_flaw(repeated, "twice");

  expect_flaw(test::join(box, box), "more than one shell");
  expect_flaw(test::make_torus(3, 1, 12, 8), "Euler characteristic is 0");

  // Two boxes that share a vertex, and two that share opposite ones, whose Euler characteristic is 2.
  Mesh pinched = test::join(box, box);
  const auto join_vertices = [&](std::uint32_t kept, std::uint32_t gone) {
    for (Triangle& t : pinched.triangles) std::replace(t.begin(), t.end(), gone, kept);
  };
  join_vertices(7, 8);
  expect_flaw(pinched, "more than one shell");
  join_vertices(0, 15);
  expect_flaw(pinched, "more than one shell");
}

TEST(ShellTopology, FindsASphereThatTouchesItself) {
  // Poles of a sphere made one vertex.
  Mesh sphere = test::make_uv_sphere(1, 8, 12);
  const auto by_height = [&](std::uint32_t a, std::uint32_t b) {
    return sphere.positions[a].z < sphere.positions[b].z;
  };
  std::vector<std::uint32_t> vertices(sphere.positions.size());
  std::iota(vertices.begin(), vertices.end(), 0U);
  const auto [south, north] = std::minmax_element(vertices.begin(), vertices.end(), by_height);
  for (Triangle& t : sphere.triangles) std::replace(t.begin(), t.end(), *north, *south);
  expect_flaw(sphere, "Euler characteristic is 1");
}

}  // namespace
}  // namespace aerate
