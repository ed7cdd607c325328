#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <tbb/global_control.h>
#include <vector>

#include "tests/support/shapes.h"
#include "tests/view/page_reader.h"
#include "view/page_geometry.h"

namespace aerate {
namespace {

using Corners = std::array<std::array<std::int64_t, 3>, 3>;

// The same triangle for any of its corners that comes first.
Corners in_order(const Corners& corners) {
  const auto& [a, b, c] = corners;
  return std::min({Corners{a, b, c}, Corners{b, c, a}, Corners{c, a, b}});
}

std::array<std::int64_t, 3> on_grid(Vec3f position, const PageGrid& grid) {
  const Vec3d p = (to_double(position) - grid.origin) * (1 / grid.step);
  return {std::llround(p.x), std::llround(p.y), std::llround(p.z)};
}

std::vector<Corners> meant(const Mesh& mesh, const SolidPart& part, const PageGrid& grid) {
  std::vector<Corners> all;
  all.reserve(part.triangle_count);
  for (const Triangle& t : triangles_of(mesh, part))
    all.push_back(in_order({on_grid(mesh.positions[t[0]], grid), on_grid(mesh.positions[t[1]], grid),
                            on_grid(mesh.positions[t[2]], grid)}));
  std::ranges::sort(all);
  return all;
}

// Whatever the triangles are, those that are read are the same, part by part.
PageGeometry expect_round_trip(const Mesh& mesh, const std::vector<SolidPart>& parts, double tolerance) {
  const PageGrid grid = page_grid(mesh, tolerance);
  PageGeometry encoded = encode_geometry(mesh, parts, grid);
  test::PageReader reader(encoded.steps, encoded.links, encoded.x, encoded.y, encoded.z);
  for (const SolidPart& part : parts) {
    const std::size_t first = reader.read().triangles.size();
    reader.read_part(part.triangle_count);
    std::vector<Corners> read;
    read.reserve(part.triangle_count);
    for (std::size_t t = first; t < reader.read().triangles.size(); ++t) {
      const Triangle& corners = reader.read().triangles[t];
      read.push_back(in_order({reader.read().places[corners[0]], reader.read().places[corners[1]],
                               reader.read().places[corners[2]]}));
    }
    std::ranges::sort(read);
    EXPECT_EQ(read, meant(mesh, part, grid));
  }
  EXPECT_TRUE(reader.is_at_end());
  EXPECT_EQ(reader.read().places.size(), encoded.vertex_count);
  return encoded;
}

PageGeometry expect_round_trip(const Mesh& mesh) {
  return expect_round_trip(mesh, {{PartKind::outer, 0, mesh.triangles.size()}}, 0.05);
}

TEST(PageGeometry, ClosedSurfacesComeBack) {
  expect_round_trip(test::make_box({0, 0, 0}, {10, 20, 30}));
  expect_round_trip(test::make_uv_sphere(10, 12, 24));
  expect_round_trip(test::make_torus(10, 3, 16, 9));
}

TEST(PageGeometry, PartsComeBackEachWithItsOwnTriangles) {
  const Mesh outside = test::make_box({0, 0, 0}, {20, 20, 20});
  const Mesh inside = test::moved(test::turned_inside_out(test::make_uv_sphere(5, 8, 12)), {10, 10, 10});
  const Mesh both = test::join(outside, inside);
  const std::size_t first = outside.triangles.size();
  expect_round_trip(
      both, {{PartKind::outer, 0, first}, {PartKind::void_surface, first, inside.triangles.size()}}, 0.05);
}

TEST(PageGeometry, PartsMayShareVertices) {
  const Mesh sphere = test::make_uv_sphere(5, 9, 14);
  std::vector<SolidPart> parts;
  for (std::size_t first = 0; first < sphere.triangles.size(); first += 7)
    parts.push_back({PartKind::channel, first, std::min<std::size_t>(7, sphere.triangles.size() - first)});
  expect_round_trip(sphere, parts, 0.05);
}

TEST(PageGeometry, OpenAndBranchingSurfacesComeBack) {
  Mesh fan{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}};
  expect_round_trip(fan);
  fan.triangles.push_back({1, 0, 2});
  fan.triangles.push_back({1, 0, 3});
  expect_round_trip(fan);
}

TEST(PageGeometry, DamagedTrianglesComeBack) {
  Mesh box = test::make_box({0, 0, 0}, {1, 2, 3});
  box.triangles.push_back(box.triangles.front());
  box.triangles.push_back({0, 0, 1});
  box.triangles.push_back({2, 1, 1});
  box.triangles.push_back({4, 4, 4});
  expect_round_trip(box);
}

TEST(PageGeometry, AnySoupComesBack) {
  std::mt19937 random(18);
  for (int round = 0; round < 200; ++round) {
    Mesh soup;
    const auto vertices = static_cast<std::uint32_t>(3 + random() % 12);
    const auto coordinate = [&] { return static_cast<float>(random() % 1000) / 10; };
    soup.positions.reserve(vertices);
    for (std::uint32_t v = 0; v < vertices; ++v)
      soup.positions.push_back({coordinate(), coordinate(), coordinate()});
    for (std::size_t t = 1 + random() % 40; t > 0; --t)
      soup.triangles.push_back({static_cast<std::uint32_t>(random() % vertices),
                                static_cast<std::uint32_t>(random() % vertices),
                                static_cast<std::uint32_t>(random() % vertices)});
    expect_round_trip(soup);
  }
}

TEST(PageGeometry, NoTrianglesAreNoBytes) {
  EXPECT_TRUE(expect_round_trip({}).steps.empty());
}

TEST(PageGeometry, PlacesAreWithinAQuarterOfTheTolerance) {
  const Mesh sphere = test::make_uv_sphere(50, 40, 60);
  for (const double tolerance : {0.5, 0.05, 0.01, 0.001}) {
    const PageGrid grid = page_grid(sphere, tolerance);
    EXPECT_LE(grid.step, tolerance / 4);
    for (const Vec3f position : sphere.positions) {
      const auto at = on_grid(position, grid);
      const Vec3d place = grid.origin + Vec3d{static_cast<double>(at[0]), static_cast<double>(at[1]),
                                              static_cast<double>(at[2])} *
                                            grid.step;
      EXPECT_LE(length(place - to_double(position)), tolerance / 4);
    }
  }
}

TEST(PageGeometry, IsTheSameForAnyNumberOfThreads) {
  const Mesh torus = test::make_torus(20, 6, 60, 40);
  std::vector<SolidPart> parts;
  for (std::size_t first = 0; first < torus.triangles.size(); first += 480)
    parts.push_back({PartKind::void_surface, first, 480});
  const PageGrid grid = page_grid(torus, 0.05);
  const PageGeometry all = encode_geometry(torus, parts, grid);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const PageGeometry alone = encode_geometry(torus, parts, grid);
  EXPECT_EQ(all.steps, alone.steps);
  EXPECT_EQ(all.links, alone.links);
  EXPECT_EQ(all.x, alone.x);
  EXPECT_EQ(all.y, alone.y);
  EXPECT_EQ(all.z, alone.z);
}

TEST(PageGeometry, TakesAboutAByteAndAHalfForATriangle) {
  const Mesh sphere = test::make_uv_sphere(10, 100, 200);
  const PageGeometry encoded = expect_round_trip(sphere);
  // Before deflate: a step a triangle, and three small numbers for every second one.
  EXPECT_LT(encoded.steps.size() + encoded.links.size(), 1.2 * static_cast<double>(sphere.triangles.size()));
  EXPECT_LT(encoded.x.size() + encoded.y.size() + encoded.z.size(),
            2.5 * static_cast<double>(sphere.triangles.size()));
}

}  // namespace
}  // namespace aerate
