#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "core/overhang.h"
#include "core/segment_distance.h"
#include "core/surface_index.h"
#include "core/void_shape.h"
#include "kernels/point_triangle.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

constexpr int kSteps = 400;

Vec3d at(const Segment& s, int i) {
  return s.start + (s.end - s.start) * (static_cast<double>(i) / kSteps);
}

// Distances on a grid of points: never less than the true one, and more by half a step at most.
double sampled(const Segment& a, const Segment& b) {
  double least = 1e300;
  for (int i = 0; i <= kSteps; ++i) least = std::min(least, distance_to_point(b, at(a, i)));
  return least;
}
double sampled(const Segment& a, const kernels::Facet& facet) {
  double least = 1e300;
  for (int i = 0; i <= kSteps; ++i)
    least = std::min(least, std::sqrt(kernels::distance_squared_to_facet(at(a, i), facet)));
  return least;
}

TEST(SegmentDistance, KnownPlaces) {
  const Segment along_x{{0, 0, 0}, {2, 0, 0}};
  EXPECT_DOUBLE_EQ(distance_to_point(along_x, {1, 3, 4}), 5);
  EXPECT_DOUBLE_EQ(distance_to_point(along_x, {5, 4, 0}), 5);
  EXPECT_DOUBLE_EQ(distance_between(along_x, {{1, -1, 3}, {1, 1, 3}}), 3);  // inside both
  EXPECT_DOUBLE_EQ(distance_between(along_x, {{0, 2, 0}, {2, 2, 0}}), 2);   // parallel
  EXPECT_DOUBLE_EQ(distance_between(along_x, {{5, 4, 0}, {9, 4, 0}}), 5);   // ends
  const kernels::Facet facet{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  EXPECT_EQ(distance_to_facet({{1, 1, -1}, {1, 1, 1}}, facet), 0);           // through the inside
  EXPECT_DOUBLE_EQ(distance_to_facet({{1, 1, 2}, {1, 1, 5}}, facet), 2);     // above it
  EXPECT_DOUBLE_EQ(distance_to_facet({{-3, 1, -1}, {-3, 1, 1}}, facet), 3);  // beside it
}

TEST(SegmentDistance, AgreesWithSamplesEverywhere) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const auto point = [&] { return Vec3d{coordinate(random), coordinate(random), coordinate(random)}; };
  for (int i = 0; i < 200; ++i) {
    const Segment a{point(), point()}, b{point(), point()};
    const double step = length(a.end - a.start) / kSteps;
    const double exact = distance_between(a, b);
    EXPECT_LE(exact, sampled(a, b) + 1e-12);
    EXPECT_GE(exact, sampled(a, b) - step);
    const kernels::Facet facet{to_float(point()), to_float(point()), to_float(point())};
    const double to_facet = distance_to_facet(a, facet);
    EXPECT_LE(to_facet, sampled(a, facet) + 1e-12);
    EXPECT_GE(to_facet, sampled(a, facet) - step);
  }
}

TEST(SegmentDistance, ToVoidsWithRoofs) {
  const Roof roof = make_roof({.degrees = 45, .bridge = 2, .up = {0, 0, 1}});
  const Sphere planned{{1, 2, 3}, 5, SphereKind::adaptive};
  // Against a dense row of balls on the spine.
  const auto by_balls = [&](const Segment& segment) {
    double nearest = 1e9;
    const double spine = roof.spine(5);
    for (int i = 0; i <= 20000; ++i) {
      const double t = spine * i / 20000;
      nearest =
          std::min(nearest, distance_to_point(segment, planned.centre + roof.up * t) - 5 + t * roof.sine);
    }
    return nearest;
  };
  for (const Segment& segment :
       {Segment{{9, 2, 3}, {9, 5, 3}}, Segment{{4, 2, 12}, {9, 2, 8}}, Segment{{1, 2, 11}, {1, 2, 14}},
        Segment{{-9, 4, 9}, {9, 4, 9}}, Segment{{1, 8, -6}, {1, 9, 20}}}) {
    const double distance = VoidShape(planned, roof).distance_to(segment);
    EXPECT_NEAR(distance, by_balls(segment), 1e-6);
    EXPECT_TRUE(VoidShape(planned, roof).is_farther_than(distance - 1e-6, segment));
    EXPECT_FALSE(VoidShape(planned, roof).is_farther_than(distance + 1e-6, segment));
    EXPECT_NEAR(VoidShape(planned, {}).distance_to(segment), distance_to_point(segment, planned.centre) - 5,
                1e-12);
  }
}

TEST(VoidShape, HoldsWhatItsRadiusDoes) {
  const Roof roof = make_roof({.degrees = 45, .bridge = 2, .up = {0, 0, 1}});
  const Sphere planned{{1, 2, 3}, 5, SphereKind::adaptive};
  const VoidShape with_roof(planned, roof), round(planned, {});
  EXPECT_DOUBLE_EQ(round.least_radius_holding({1, 2, 7}), 4);
  EXPECT_DOUBLE_EQ(with_roof.least_radius_holding({1, 2, -1}), 4);
  EXPECT_NEAR(with_roof.least_radius_holding({1, 2, 3 + roof.top(5)}), 5, 1e-12);  // its flat top's middle
  EXPECT_DOUBLE_EQ(with_roof.least_radius_holding({1, 2, 4}), 1);  // so small a void has no roof
  const kernels::Facet below{{0, 2, 0}, {2, 2, 0}, {1, 3, 0}};
  EXPECT_DOUBLE_EQ(round.depth(below), 2);
  EXPECT_DOUBLE_EQ(with_roof.depth(below), 2);
  const auto top = static_cast<float>(3 + roof.top(5) - 0.25);
  EXPECT_NEAR(with_roof.depth({{0, 2, top}, {2, 2, top}, {1, 3, top}}), 0.25, 1e-6);
  EXPECT_DOUBLE_EQ(round.volume_within(0.5), round.volume() * 0.9 * 0.9 * 0.9);
}

TEST(SurfaceIndex, TrianglesNearAreTheSameByHierarchyAndByLookingAtAll) {
  const Mesh sphere = test::make_uv_sphere(10, 40, 60);
  const SurfaceIndex index(sphere);
  for (const double reach : {0.3, 1.0, 4.0}) {
    const Segment segment{{0, 0, 0}, {9, 6, 4}};
    const std::vector<std::uint32_t> found = index.triangles_near(segment, reach);
    EXPECT_FALSE(found.empty());
    EXPECT_EQ(found, triangles_near(sphere, segment, reach));
  }
}

}  // namespace
}  // namespace aerate
