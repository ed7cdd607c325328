#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "core/surface_index.h"
#include "kernels/constants.h"
#include "packing/ray_facets.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

// Triangles of all sizes anywhere in a cube, about a place.
Mesh scattered(std::uint32_t count, float size, Vec3f about) {
  Mesh mesh;
  std::mt19937 random(11);
  std::uniform_real_distribution<float> place(0, 20), aside(-size, size);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3f at = about + Vec3f{place(random), place(random), place(random)};
    for (int corner = 0; corner < 3; ++corner)
      mesh.positions.push_back(at + Vec3f{aside(random), aside(random), aside(random)});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

// Where a ray meets a triangle, by its plane and its sides; infinite if it does not.
double along_ray(Vec3d start, Vec3d direction, const kernels::Facet& facet) {
  const Vec3d a = to_double(facet.a), b = to_double(facet.b), c = to_double(facet.c);
  const Vec3d normal = cross(b - a, c - a);
  const double steepness = dot(normal, direction);
  if (steepness == 0) return kInfinity;
  const double along = dot(normal, a - start) / steepness;
  const Vec3d at = start + direction * along;
  const bool is_within = dot(cross(b - a, at - a), normal) >= 0 && dot(cross(c - b, at - b), normal) >= 0 &&
                         dot(cross(a - c, at - c), normal) >= 0;
  return is_within && along > 0 ? along : kInfinity;
}

struct Ray {
  Vec3d start, direction;
};

// Every fourth along an axis.
std::vector<Ray> rays_about(Vec3d about, std::size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-5, 25);
  std::normal_distribution<double> way;
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3d direction = normalised(Vec3d{way(random), way(random), way(random)});
    if (i % 4 == 0) direction = {i % 12 == 0 ? 1.0 : 0, i % 12 == 4 ? -1.0 : 0, i % 12 == 8 ? 1.0 : 0};
    rays.push_back({about + Vec3d{place(random), place(random), place(random)}, direction});
  }
  return rays;
}

// Gives how many rays meet a facet.
std::size_t expect_as_one_by_one(const Mesh& mesh, Vec3d about, double longest) {
  const SurfaceIndex surface(mesh);
  const RayFacets rays(surface.bvh());
  std::size_t hits = 0;
  for (const auto& [start, direction] : rays_about(about, 600)) {
    double nearest = kInfinity;
    for (const Triangle& t : mesh.triangles)
      nearest = std::min(nearest, along_ray(start, direction, facet_of(mesh, t)));
    const auto hit = rays.first_hit(start, direction, longest);
    EXPECT_EQ(hit.has_value(), nearest < longest);
    EXPECT_EQ(rays.is_hit(start, direction, longest), nearest < longest);
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(hit->along, nearest, 1e-9 * (1 + nearest));
    EXPECT_NEAR(along_ray(start, direction, surface.bvh().facets[hit->facet]), hit->along,
                1e-9 * (1 + nearest));
  }
  return hits;
}

}  // namespace

TEST(RayFacets, MeetWhatTheyMeetOneByOne) {
  // Trees of any height, with leaves that are not full.
  for (const std::uint32_t count : {1U, 3U, 4U, 5U, 9U, 17U, 65U, 300U})
    expect_as_one_by_one(scattered(count, 6, {0, 0, 0}), {0, 0, 0}, 1e9);
  EXPECT_GT(expect_as_one_by_one(scattered(2000, 1.5F, {0, 0, 0}), {0, 0, 0}, 1e9), 150U);
}

TEST(RayFacets, AreAsLongAsIsSaid) {
  const std::size_t all = expect_as_one_by_one(scattered(800, 1.5F, {0, 0, 0}), {0, 0, 0}, 1e9);
  const std::size_t near = expect_as_one_by_one(scattered(800, 1.5F, {0, 0, 0}), {0, 0, 0}, 6);
  EXPECT_GT(near, 50U);
  EXPECT_LT(near, all);
}

TEST(RayFacets, MeetSmallTrianglesFarFromTheOrigin) {
  EXPECT_GT(expect_as_one_by_one(scattered(2000, 0.4F, {900, -700, 400}), {900, -700, 400}, 1e9), 20U);
}

TEST(RayFacets, RunWithinPlanesOfBoxes) {
  // Along the boxes' own sides, which hold the start in rounding alone.
  const Mesh box = test::make_box({0, 0, 0}, {40, 40, 40});
  const SurfaceIndex surface(box);
  const RayFacets rays(surface.bvh());
  EXPECT_NEAR(rays.first_hit({20, 21, 12}, {0, 0, -1}, 50).value().along, 12, 1e-12);
  EXPECT_NEAR(rays.first_hit({20, 21, -3}, {0, 0, 1}, 50).value().along, 3, 1e-12);
  EXPECT_FALSE(rays.is_hit({20, 21, 40.001}, {1, 0, 0}, 100));
  EXPECT_TRUE(rays.is_hit({20, 21, 39.999}, {1, 0, 0}, 100));
}

TEST(RayFacets, OfNoFacetsMeetNothing) {
  const SurfaceIndex surface{Mesh{}};
  EXPECT_FALSE(RayFacets(surface.bvh()).is_hit({0, 0, 0}, {1, 0, 0}, 1e9));
}

}  // namespace aerate
