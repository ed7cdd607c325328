#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "core/facet_distance.h"
#include "core/surface_index.h"
#include "kernels/point_triangle.h"
#include "kernels/triangle_bvh.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using kernels::Facet;

constexpr int kSteps = 40;

// From points all over one triangle to the other: never less than the true distance, and more by no more than
// `coarseness` of the first.
double sampled(const Facet& a, const Facet& b) {
  const Vec3d origin = to_double(a.a), u = to_double(a.b) - origin, v = to_double(a.c) - origin;
  double least = 1e300;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const Vec3d p = origin + u * (i / double{kSteps}) + v * (j / double{kSteps});
      least = std::min(least, kernels::distance_squared_to_facet(p, b));
    }
  }
  return std::sqrt(least);
}

// Every point of a triangle is so near to a sample.
double coarseness(const Facet& a) {
  const Vec3d origin = to_double(a.a);
  return (length(to_double(a.b) - origin) + length(to_double(a.c) - origin)) / kSteps;
}

// Random triangles about a place.
class Triangles {
 public:
  explicit Triangles(unsigned seed) : random_(seed) {}

  Facet next(Vec3d about, double size) {
    const auto corner = [&] {
      const double x = coordinate_(random_), y = coordinate_(random_), z = coordinate_(random_);
      return to_float(about + Vec3d{x, y, z} * size);
    };
    const Vec3f a = corner(), b = corner(), c = corner();
    return {a, b, c};
  }
  Vec3d place(double size) { return to_double(next({0, 0, 0}, size).a); }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<double> coordinate_{-1, 1};
};

TEST(FacetDistance, KnownPlaces) {
  const Facet flat{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  EXPECT_EQ(distance_between(flat, flat), 0);
  EXPECT_EQ(distance_between(flat, {{1, 1, -1}, {1, 1, 1}, {2, 1, 1}}), 0);   // a side through the inside
  EXPECT_EQ(distance_between(flat, {{4, 0, 0}, {9, 1, 2}, {9, 2, 5}}), 0);    // in a corner
  EXPECT_EQ(distance_between(flat, {{1, -1, 0}, {3, -1, 0}, {2, 1, 0}}), 0);  // in its plane
  // Through the middle of a large one, no side of which is near.
  EXPECT_EQ(distance_between(flat, {{-90, 1, 0}, {90, 1, 90}, {90, 1, -90}}), 0);
  EXPECT_DOUBLE_EQ(distance_between(flat, {{0, 0, 3}, {4, 0, 3}, {0, 4, 3}}), 3);  // parallel
  EXPECT_DOUBLE_EQ(distance_between(flat, {{1, 1, 2}, {2, 1, 5}, {1, 2, 5}}),
                   2);  // a corner above the inside
  EXPECT_DOUBLE_EQ(distance_between(flat, {{2, -3, 4}, {2, -9, 4}, {2, -9, 9}}),
                   5);  // a corner beside a side
  EXPECT_DOUBLE_EQ(distance_between(flat, {{-3, -4, 0}, {-9, -4, 0}, {-9, -9, 0}}), 5);  // corner to corner
  EXPECT_DOUBLE_EQ(distance_between(flat, {{2, -1, -9}, {2, -1, 9}, {2, -9, 0}}), 1);    // side to side
}

TEST(FacetDistance, OfTrianglesWithoutArea) {
  const Facet point{{1, 1, 2}, {1, 1, 2}, {1, 1, 2}};
  const Facet line{{0, 0, 5}, {2, 2, 5}, {1, 1, 5}};
  EXPECT_DOUBLE_EQ(distance_between(point, line), 3);
  EXPECT_DOUBLE_EQ(distance_between({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, point), 2);
}

TEST(FacetDistance, AgreesWithSamplesEverywhere) {
  Triangles triangles(5);
  int met = 0;
  for (int i = 0; i < 1500; ++i) {
    const double apart = 0.5 * (i % 6);
    const Facet a = triangles.next({0, 0, 0}, 1),
                b = triangles.next(normalised(triangles.place(1)) * apart, 1);
    const double exact = distance_between(a, b);
    EXPECT_NEAR(exact, distance_between(b, a), 1e-12);
    const double by_samples = std::min(sampled(a, b), sampled(b, a));
    EXPECT_LE(exact, by_samples + 1e-12);
    EXPECT_GE(exact, by_samples - std::min(coarseness(a), coarseness(b)));
    met += exact == 0 ? 1 : 0;
  }
  EXPECT_GT(met, 100);
  EXPECT_LT(met, 1000);
}

// Sampling is coarse; that a step in any direction makes the distance no longer than the step is not.
TEST(FacetDistance, ChangesByNoMoreThanTheWay) {
  Triangles triangles(8);
  for (int i = 0; i < 500; ++i) {
    const Facet a = triangles.next({0, 0, 0}, 1), b = triangles.next(triangles.place(2), 1);
    const Vec3f step = to_float(triangles.place(0.01));
    const Facet moved{b.a + step, b.b + step, b.c + step};
    EXPECT_NEAR(distance_between(a, moved), distance_between(a, b), length(to_double(step)) + 1e-6);
  }
}

double to_surface_by_brute_force(const Facet& facet, const Mesh& mesh, double limit) {
  double least = limit;
  for (const Triangle& t : mesh.triangles)
    least = std::min(least, distance_between(facet, facet_of(mesh, t)));
  return least;
}

TEST(DistanceToSurface, IsTheLeastOfAllTriangles) {
  const Mesh sphere = test::make_uv_sphere(10, 20, 30);
  const SurfaceIndex index(sphere);
  Triangles triangles(3);
  int nearer = 0;
  for (int i = 0; i < 400; ++i) {
    // Small and large ones, inside, outside and through.
    const Facet facet = triangles.next(triangles.place(14), i % 3 == 0 ? 6 : 0.5);
    for (const double limit : {1e9, 2.0, 0.3}) {
      const double expected = to_surface_by_brute_force(facet, sphere, limit);
      EXPECT_NEAR(distance_to_surface(facet, index.bvh(), limit), expected, 1e-12);
      nearer += expected < limit ? 1 : 0;
    }
  }
  EXPECT_GT(nearer, 500);
}

// Facets that are parallel to the surface, as those of voids are.
TEST(DistanceToSurface, BesideFlatFaces) {
  const Mesh box = test::make_box({0, 0, 0}, {30, 30, 30});
  const SurfaceIndex index(box);
  const Facet below_top{{5, 5, 28}, {25, 5, 28}, {5, 25, 28}};
  EXPECT_DOUBLE_EQ(distance_to_surface(below_top, index.bvh(), 100), 2);
  EXPECT_DOUBLE_EQ(distance_to_surface(below_top, index.bvh(), 2.5), 2);
  EXPECT_DOUBLE_EQ(distance_to_surface(below_top, index.bvh(), 2), 2);
  EXPECT_DOUBLE_EQ(distance_to_surface(below_top, index.bvh(), 1.5), 1.5);  // the limit
  EXPECT_EQ(distance_to_surface({{5, 5, 30}, {25, 5, 30}, {5, 25, 30}}, index.bvh(), 1), 0);
}

TEST(DistanceToSurface, OfNothingIsTheLimit) {
  const kernels::HostTriangleBvh nothing({}, {});
  EXPECT_DOUBLE_EQ(distance_to_surface({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, nothing.view(), 7), 7);
}

TEST(BoxDistance, IsThatOfTheNearestCorners) {
  const Box3d box{{0, 0, 0}, {1, 2, 3}};
  EXPECT_EQ(distance_squared(box, {{4, 6, 3}, {5, 7, 8}}), 9 + 16);
  EXPECT_EQ(distance_squared(box, {{-5, -7, -8}, {-4, -6, -2}}), 16 + 36 + 4);
  EXPECT_EQ(distance_squared(box, {{0.5, 0.5, 3.5}, {9, 9, 9}}), 0.25);  // above
  EXPECT_EQ(distance_squared(box, {{1, 2, 3}, {9, 9, 9}}), 0);           // in one corner
  EXPECT_EQ(distance_squared(box, {{-1, 1, 1}, {9, 1.5, 2}}), 0);        // across
}

}  // namespace
}  // namespace aerate
