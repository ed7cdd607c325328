#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <tbb/global_control.h>

#include "core/overhang.h"
#include "kernels/roof_distance.h"
#include "printing/carve.h"
#include "printing/cut_ball.h"
#include "tests/support/clearance.h"
#include "tests/support/closed_shells.h"
#include "tests/support/packing_of.h"
#include "tests/support/shapes.h"

// Voids with roofs as they are carved: closed, inside their planned shape, near to it, flat on top.
namespace aerate {
namespace {

Sphere ball(Vec3d centre, double radius) {
  return {centre, radius, SphereKind::adaptive};
}

Solid carve(const Packing& packing, double tolerance) {
  Monitor monitor;
  return carve_keeping_surface(test::make_box({-100, -100, -100}, {101, 101, 101}), packing, {tolerance},
                               monitor);
}

Mesh void_surface(const Solid& solid, std::size_t i) {
  return test::turned_inside_out(test::extract(solid.mesh, solid.of(PartKind::void_surface)[i]));
}

double height_of(const Roof& roof, const Sphere& sphere, Vec3f p) {
  return dot(to_double(p) - sphere.centre, roof.up);
}

void expect_good_void(const Mesh& surface, const Roof& roof, const Sphere& sphere, double tolerance) {
  EXPECT_TRUE(test::is_closed_manifold(surface));
  EXPECT_EQ(test::euler_characteristic(surface), 2);
  EXPECT_TRUE(test::is_star_shaped(surface, sphere.centre));
  const double top = roof.top(sphere.radius);
  for (const Vec3f& p : surface.positions) {
    const double radius = roof.shapes(sphere.radius) ? lateral_radius(roof, sphere.centre, to_double(p))
                                                     : length(to_double(p) - sphere.centre);
    ASSERT_LE(radius, sphere.radius);
    ASSERT_LE(height_of(roof, sphere, p), top);
  }
  for (const Triangle& t : surface.triangles) {
    double depth = kernels::lateral_depth(roof, sphere.centre, sphere.radius, facet_of(surface, t));
    if (roof.shapes(sphere.radius)) {
      double lowest = top;
      for (const std::uint32_t v : t)
        lowest = std::min(lowest, height_of(roof, sphere, surface.positions[v]));
      depth = std::min(depth, top - lowest);
    } else {
      depth =
          sphere.radius - std::sqrt(kernels::distance_squared_to_facet(sphere.centre, facet_of(surface, t)));
    }
    ASSERT_LE(depth, tolerance * (1 + 1e-9));
  }
  EXPECT_GE(signed_volume(surface), 0.9 * void_volume(roof, sphere.radius) * (1 - 1e-5));
  EXPECT_LE(signed_volume(surface), void_volume(roof, sphere.radius));
}

// Largest distance from the axis of a vertex at the void's top, and how many there are.
struct Top {
  double radius = 0;
  int vertices = 0;
};
Top top_of(const Mesh& surface, const Roof& roof, const Sphere& sphere) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const Vec3f& p : surface.positions) highest = std::max(highest, height_of(roof, sphere, p));
  Top top;
  for (const Vec3f& p : surface.positions) {
    const double height = height_of(roof, sphere, p);
    if (height < highest - 1e-4) continue;
    ++top.vertices;
    top.radius = std::max(top.radius, length(to_double(p) - sphere.centre - roof.up * height));
  }
  return top;
}

std::vector<Roof> roofs() {
  return {make_roof({}),
          make_roof({.degrees = 30, .bridge = 2, .up = {0, -1, 0}}),
          make_roof({.degrees = 60, .bridge = 8, .up = {1, 0, 0}}),
          make_roof({.degrees = 45, .bridge = 0}),
          make_roof({.degrees = 50, .bridge = 0.02, .up = {1, -2, 0.5}}),
          make_roof({.degrees = 20, .bridge = 5}),
          make_roof({.degrees = 75, .bridge = 3, .up = {0.3, 0.1, -1}})};
}

TEST(RoofedVoids, LieInsideTheirShapeWithinTheTolerance) {
  std::size_t roof_count = 0;
  for (const Roof& roof : roofs()) {
    Packing packing = test::packing_of({}, roof);
    for (const double radius : {0.7, 3.0, 3.54, 4.2, 9.5}) {
      packing.spheres.push_back(ball({17.3 + radius, 50.1 - radius, 3.7 * radius}, radius));
      packing.spheres.push_back(ball({-60.7, 70.3, 0.01}, radius));
    }
    // Fine surfaces take long: of two roofs only.
    for (const double tolerance : {0.3, roof_count++ < 2 ? 0.05 : 0.15}) {
      const Solid solid = carve(packing, tolerance);
      ASSERT_EQ(solid.of(PartKind::void_surface).size(), packing.spheres.size());
      for (std::size_t i = 0; i < packing.spheres.size(); ++i) {
        SCOPED_TRACE("overhang " + std::to_string(overhang_degrees(roof)) + ", radius " +
                     std::to_string(packing.spheres[i].radius) + ", tolerance " + std::to_string(tolerance));
        expect_good_void(void_surface(solid, i), roof, packing.spheres[i], tolerance);
      }
      EXPECT_EQ(estimate_void_triangles(packing, {tolerance}), solid.mesh.triangles.size() - 12);
      EXPECT_GE(most_void_triangles(packing, {tolerance}), estimate_void_triangles(packing, {tolerance}));
    }
  }
}

TEST(RoofedVoids, AreFlatOnTopAndAsWideAsTheBridge) {
  const Packing packing =
      test::packing_of({ball({11.3, 20.7, 31.9}, 9.5), ball({60, 60, 60}, 4)}, make_roof({}));
  const Solid solid = carve(packing, 0.05);
  for (std::size_t i = 0; i < 2; ++i) {
    const Mesh surface = void_surface(solid, i);
    const Top top = top_of(surface, packing.limits.roof, packing.spheres[i]);
    EXPECT_GE(top.vertices, 12);
    EXPECT_LE(top.radius, 2.5);
    EXPECT_GT(top.radius, 2.499);
    const float highest = bounding_box(surface).upper.z;
    int at_top = 0;
    for (const Vec3f& p : surface.positions) at_top += p.z == highest ? 1 : 0;
    EXPECT_EQ(at_top, top.vertices) << "the top is exactly flat";
  }
  EXPECT_NEAR(bounding_box(void_surface(solid, 0)).upper.z, 31.9 + 10.935, 1e-3);
}

TEST(RoofedVoids, TopsThatAreAlmostBallsOrPointsAreSound) {
  const Roof roof = make_roof({});
  Packing packing = test::packing_of({}, roof);
  for (const double more : {1e-12, 1e-7, 1e-5, 1e-4, 1e-3, 0.01, 0.1}) {
    packing.spheres.push_back(ball({11.3, 20.7, 31.9}, roof.widest_ball + more));
  }
  const Solid solid = carve(packing, 0.02);
  for (std::size_t i = 0; i < packing.spheres.size(); ++i) {
    SCOPED_TRACE(i);
    expect_good_void(void_surface(solid, i), roof, packing.spheres[i], 0.02);
    EXPECT_GE(top_of(void_surface(solid, i), roof, packing.spheres[i]).vertices, 12);
  }
}

TEST(RoofedVoids, TakeFewTriangles) {
  constexpr double kTolerance = 0.05;
  for (const double radius : {4.0, 6.0, 9.5}) {
    const Packing roofed = test::packing_of({ball({40, 50, 60}, radius)}, make_roof({}));
    const Packing free = test::packing_of({ball({40, 50, 60}, radius)});
    const auto with = static_cast<double>(estimate_void_triangles(roofed, {kTolerance}));
    const auto without = static_cast<double>(estimate_void_triangles(free, {kTolerance}));
    RecordProperty("radius_" + std::to_string(radius), std::to_string(with / without));
    EXPECT_LT(with, 2 * without) << radius;
  }
}

TEST(RoofedVoids, FindTheToleranceForATriangleBudget) {
  const Packing packing =
      test::packing_of({ball({20, 20, 20}, 9), ball({70, 70, 70}, 5), ball({20, 70, 70}, 2)}, make_roof({}));
  const CarveOptions options{0.03};
  const std::size_t finest = estimate_void_triangles(packing, options);
  const std::optional<double> tolerance = loosen_tolerance(packing, options, finest / 3);
  ASSERT_TRUE(tolerance);
  EXPECT_GT(*tolerance, options.tolerance);
  EXPECT_LE(estimate_void_triangles(packing, {*tolerance}), finest / 3);
  EXPECT_EQ(loosen_tolerance(packing, options, 10), std::nullopt);
}

TEST(RoofedVoids, SameBytesForAnyThreadCount) {
  Packing packing = test::packing_of({}, make_roof({}));
  for (int i = 0; i < 60; ++i)
    packing.spheres.push_back(ball({3.0 * (i % 10), 3.0 * (i / 10), 0}, 1 + 0.06 * i));
  Solid first;
  for (const std::size_t threads : {1u, 2u, 8u}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Solid solid = carve(packing, 0.05);
    if (threads == 1) first = solid;
    EXPECT_EQ(solid.mesh.triangles, first.mesh.triangles) << threads << " threads";
    EXPECT_EQ(solid.mesh.positions, first.mesh.positions) << threads << " threads";
  }
}

TEST(CutBall, MostLevelsOfTheLadderCanBeCut) {
  BallLadder ladder;
  for (const Roof& roof : {make_roof({}), make_roof({.degrees = 25}), make_roof({.degrees = 70}),
                           make_roof({.degrees = 82}), make_roof({.degrees = 86})}) {
    int cut = 0, all = 0;
    double worst = 0;
    for (std::size_t level = 0; level < 40; ++level) {
      const BallTemplate* made = ladder.find(level);
      if (made == nullptr) continue;
      ++all;
      const std::optional<CutBall> lower = cut_ball(*made, roof);
      if (!lower) continue;
      ++cut;
      worst = std::max(worst, lower->sagitta / made->sagitta);
      for (std::size_t i = 0; i < lower->ring_count; ++i)
        EXPECT_NEAR(lower->directions[i].z, roof.sine, 1e-12);
    }
    EXPECT_GE(cut, all * 9 / 10) << overhang_degrees(roof);
    RecordProperty("worst_" + std::to_string(overhang_degrees(roof)), std::to_string(worst));
  }
}

}  // namespace
}  // namespace aerate
