#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

#include "kernels/exec_cpu.h"
#include "kernels/nearest_point.h"
#include "kernels/triangle_bvh.h"
#include "kernels/winding.h"
#include "tests/support/shapes.h"

namespace aerate::kernels {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Triangles of all sizes: slivers, segments and points among them, some far away from the rest.
Mesh random_triangles(std::uint32_t seed, std::size_t count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  Mesh mesh;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f base{uniform(random) * 10, uniform(random) * 10,
                     uniform(random) * (i % 7 == 0 ? 1000.0f : 1.0f)};
    const float size = std::pow(10.0f, -3.0f * (uniform(random) + 1.0f) / 2.0f);
    const Vec3f b = base + Vec3f{uniform(random), uniform(random), uniform(random)} * size;
    Vec3f c = base + Vec3f{uniform(random), uniform(random), uniform(random)} * size;
    if (i % 5 == 1) c = base;                                 // a segment
    if (i % 5 == 2) c = base + (b - base) * 0.5f;             // collinear, or nearly
    if (i % 5 == 3) c = b + Vec3f{size * 1e-4f, 0.0f, 0.0f};  // a sliver
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {base, i % 25 == 4 ? base : b, i % 25 == 4 ? base : c});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

std::vector<Vec3d> random_points(std::uint32_t seed, std::size_t count, double extent) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-extent, extent);
  std::vector<Vec3d> points(count);
  for (Vec3d& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

double brute_force_distance_squared(const Mesh& mesh, Vec3d p) {
  double least = kInfinity;
  for (const Triangle& t : mesh.triangles) {
    const Facet facet{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    least = std::min(least, distance_squared_to_facet(p, facet));
  }
  return least;
}

TEST(TriangleBvh, EqualsBruteForceOnDegenerateTriangles) {
  for (const std::size_t count : {1u, 3u, 4u, 5u, 8u, 33u, 1000u}) {
    const Mesh mesh = random_triangles(static_cast<std::uint32_t>(count), count);
    const HostTriangleBvh bvh(mesh.positions, mesh.triangles);
    const std::vector<Vec3d> points = random_points(7, 500, 15);
    const std::vector<double> distances = bvh.distances(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(distances[i], std::sqrt(brute_force_distance_squared(mesh, points[i]))) << count << " " << i;
    }
  }
}

TEST(TriangleBvh, FindsOnlyWhatIsCloserThanTheLimit) {
  const Mesh mesh = random_triangles(3, 400);
  const HostTriangleBvh bvh(mesh.positions, mesh.triangles);
  for (const Vec3d p : random_points(11, 300, 12)) {
    const double exact = brute_force_distance_squared(mesh, p);
    const NearestFacet within = bvh.view().nearest(p, exact * 1.0001 + 1e-300);
    EXPECT_EQ(within.distance_squared, exact);
    ASSERT_NE(within.facet, kNone);
    const Triangle t = mesh.triangles[bvh.view().order[within.facet]];
    EXPECT_EQ(
        distance_squared_to_facet(p, {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]}),
        exact);
    EXPECT_EQ(bvh.view().nearest(p, exact).facet, kNone);
  }
}

TEST(TriangleBvh, NearestPointIsAtTheDistance) {
  const Mesh mesh = random_triangles(5, 200);
  for (const Vec3d p : random_points(13, 20, 12)) {
    for (const Triangle& t : mesh.triangles) {
      const Facet facet{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
      const double distance = std::sqrt(distance_squared_to_facet(p, facet));
      const FacetPoint nearest = nearest_point_on_facet(p, facet);
      EXPECT_NEAR(length(p - nearest.point), distance, 1e-9 * (1 + distance));
    }
  }
}

TEST(TriangleBvh, SerialAndParallelBuildsAreEqual) {
  const Mesh mesh = random_triangles(9, 3000);
  const SerialExecutor serial;
  const TbbExecutor parallel;
  const auto facets = gather_facets(serial, mesh.positions, mesh.triangles);
  const View<const Facet> view = facets.view();
  const auto a = build_triangle_bvh(serial, view, bounding_box(view));
  const auto b = build_triangle_bvh(parallel, view, bounding_box(view));
  ASSERT_EQ(a.order.size(), b.order.size());
  for (std::size_t i = 0; i < a.order.size(); ++i) ASSERT_EQ(a.order.view()[i], b.order.view()[i]);
  for (const Vec3d p : random_points(17, 200, 12)) {
    EXPECT_EQ(a.view.nearest(p, kInfinity).facet, b.view.nearest(p, kInfinity).facet);
  }
}

}  // namespace
}  // namespace aerate::kernels
