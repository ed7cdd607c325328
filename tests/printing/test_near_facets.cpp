#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <vector>

#include "core/surface_index.h"
#include "kernels/constants.h"
#include "kernels/point_triangle.h"
#include "printing/cells/near_facets.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

std::vector<Vec3d> points_about(const Mesh& mesh, std::size_t count) {
  const Box3f box = bounding_box(mesh);
  const Vec3d lower = to_double(box.lower), size = to_double(box.upper) - lower;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(-0.2, 1.2);
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(lower + Vec3d{size.x * share(random), size.y * share(random), size.z * share(random)});
  return points;
}

void expect_as_hierarchy(const Mesh& mesh, double limit) {
  const SurfaceIndex surface(mesh);
  const NearFacets near(surface.bvh());
  for (const Vec3d p : points_about(mesh, 400)) {
    const kernels::NearestFacet expected = surface.bvh().nearest(p, limit * limit);
    const kernels::NearestFacet found = near.nearer_than(p, {limit * limit, kNone});
    // The same bits, whichever of several facets it is.
    EXPECT_EQ(found.distance_squared, expected.distance_squared);
    EXPECT_EQ(found.facet == kNone, expected.facet == kNone);
    if (found.facet == kNone) continue;
    EXPECT_EQ(kernels::distance_squared_to_facet(p, near.facet(found.facet)), found.distance_squared);
  }
}

// Thin ones, some without an area.
Mesh needles() {
  Mesh mesh;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(0, 50), width(0, 2e-4F);
  for (std::uint32_t i = 0; i < 200; ++i) {
    const Vec3f from{place(random), place(random), place(random)};
    const Vec3f to{place(random), place(random), place(random)};
    const float beside = i % 5 == 0 ? 0.F : width(random);
    mesh.positions.insert(mesh.positions.end(), {from, to, {from.x + beside, from.y, from.z}});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

Mesh moved(Mesh mesh, Vec3f way) {
  for (Vec3f& p : mesh.positions) p = p + way;
  return mesh;
}

}  // namespace

TEST(NearFacets, DistancesAreThoseOfTheHierarchy) {
  const Mesh ball = test::make_uv_sphere(20, 30, 40);
  expect_as_hierarchy(ball, 5);
  expect_as_hierarchy(ball, 1e3);
  expect_as_hierarchy(test::make_box({-20, -20, -20}, {20, 20, 20}), 30);
}

TEST(NearFacets, NeedlesAreAsGoodAsAnyTriangle) {
  expect_as_hierarchy(needles(), 100);
}

TEST(NearFacets, FarFromTheOriginRoundingIsAllowedFor) {
  expect_as_hierarchy(moved(test::make_uv_sphere(5, 30, 40), {900, -700, 3000}), 10);
}

TEST(NearFacets, ListsAllThatAreNear) {
  const Mesh ball = moved(test::make_uv_sphere(20, 30, 40), {3, 4, 5});
  const SurfaceIndex surface(ball);
  const NearFacets near(surface.bvh());
  for (const Vec3d p : points_about(ball, 100)) {
    std::set<std::uint32_t> listed;
    near.for_each_near(p, 6, [&](std::uint32_t i) { EXPECT_TRUE(listed.insert(i).second); });
    std::size_t far = 0;
    for (std::uint32_t i = 0; i < ball.triangles.size(); ++i) {
      const double distance = std::sqrt(kernels::distance_squared_to_facet(p, near.facet(i)));
      EXPECT_TRUE(distance >= 6 || listed.contains(i));
      far += distance > 6.5 && listed.contains(i) ? 1U : 0U;
    }
    EXPECT_LE(far, listed.size() / 4);
  }
}

TEST(NearFacets, WithoutFacetsNothingIsNear) {
  const SurfaceIndex surface{Mesh{}};
  const NearFacets near(surface.bvh());
  EXPECT_EQ(near.nearer_than({0, 0, 0}, {4, kNone}).facet, kNone);
}

}  // namespace aerate
