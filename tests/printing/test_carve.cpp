#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <set>
#include <string>
#include <tbb/global_control.h>

#include "core/error.h"
#include "printing/ball_template.h"
#include "printing/carve.h"
#include "tests/support/closed_shells.h"
#include "tests/support/packing_of.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

constexpr double kIdealTriangles = 4.84;  // times radius / tolerance: equilateral triangles on a sphere

Sphere ball(Vec3d centre, double radius) {
  return {centre, radius, SphereKind::lattice};
}

double ball_volume(double radius) {
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

Solid carve(const Packing& packing, double tolerance) {
  Monitor monitor;
  return carve_keeping_surface(test::make_box({-1, -1, -1}, {101, 101, 101}), packing, {tolerance}, monitor);
}

// A void surface as it is seen from outside the model: turned so that its volume is positive.
Mesh void_surface(const Solid& solid, std::size_t i) {
  return test::turned_inside_out(test::extract(solid.mesh, solid.of(PartKind::void_surface)[i]));
}

void expect_good_void(const Mesh& surface, const Sphere& sphere, double tolerance) {
  EXPECT_TRUE(test::is_closed_manifold(surface));
  EXPECT_EQ(test::euler_characteristic(surface), 2);
  EXPECT_TRUE(test::is_star_shaped(surface, sphere.centre));
  const test::Deviation deviation = test::deviation_from(surface, sphere);
  EXPECT_LE(deviation.highest, 0) << "the void is larger than planned";
  EXPECT_GE(deviation.lowest, -tolerance);
  EXPECT_GE(signed_volume(surface), 0.9 * ball_volume(sphere.radius) * (1 - 1e-5));
  EXPECT_LE(signed_volume(surface), ball_volume(sphere.radius));
}

TEST(Carve, VoidsLieInsideTheirSphereWithinTheTolerance) {
  Packing packing;
  for (const double radius : {0.04, 0.3, 0.62, 1.0, 1.7, 3.0, 4.2, 9.5, 20.0}) {
    packing.spheres.push_back(ball({17.3 + radius, 50.1 - radius, 33.7 * radius}, radius));
    packing.spheres.push_back(ball({0, 0, 0}, radius));
    packing.spheres.push_back(ball({-60.7, 70.3, 0.01}, radius));
    if (radius > 0.1) packing.spheres.push_back(ball({-900.7, 1100.3, 0.01}, radius));
  }
  for (const double tolerance : {0.5, 0.05, 0.01}) {
    const Solid solid = carve(packing, tolerance);
    ASSERT_EQ(solid.of(PartKind::void_surface).size(), packing.spheres.size());
    for (std::size_t i = 0; i < packing.spheres.size(); ++i) {
      SCOPED_TRACE("sphere " + std::to_string(i) + ", tolerance " + std::to_string(tolerance));
      expect_good_void(void_surface(solid, i), packing.spheres[i], tolerance);
    }
  }
}

TEST(Carve, TakesAtMostTwiceTheTrianglesOfEquilateralOnes) {
  constexpr double kTolerance = 0.05;
  for (const double radius : {1.0, 3.0, 9.5}) {
    const Solid solid = carve(test::packing_of({ball({40, 50, 60}, radius)}), kTolerance);
    EXPECT_LE(static_cast<double>(solid.of(PartKind::void_surface)[0].triangle_count),
              2 * kIdealTriangles * radius / kTolerance)
        << "radius " << radius;
  }
}

TEST(Carve, KeepsTheOuterSurfaceAndListsShellsInOrder) {
  const Packing packing =
      test::packing_of({ball({20, 20, 20}, 5), ball({70, 70, 70}, 1), ball({20, 70, 70}, 2)});
  const Mesh outer = test::make_box({-1, -1, -1}, {101, 101, 101});
  const Solid solid = carve(packing, 0.05);
  EXPECT_EQ(solid.outer_triangle_count(), 12);
  EXPECT_TRUE(std::equal(outer.triangles.begin(), outer.triangles.end(), solid.mesh.triangles.begin()));
  EXPECT_TRUE(std::equal(outer.positions.begin(), outer.positions.end(), solid.mesh.positions.begin()));
  EXPECT_TRUE(test::is_closed_manifold(solid.mesh));

  std::size_t next_triangle = 12;
  for (const SolidPart& range : solid.of(PartKind::void_surface)) {
    EXPECT_EQ(range.first_triangle, next_triangle);
    next_triangle += range.triangle_count;
  }
  EXPECT_EQ(next_triangle, solid.mesh.triangles.size());
  EXPECT_LT(signed_volume(solid.mesh), signed_volume(outer));
}

TEST(Carve, VoidsThatTouchStayApart) {
  // Touching along the x axis, at coordinates that fp32 rounds.
  Packing packing;
  double x = 1.0 / 3;
  for (const double radius : {1.1, 0.7, 2.3, 0.9}) {
    packing.spheres.push_back(ball({x + radius, 50.0 / 7, 1000.0 / 7}, radius));
    x += 2 * radius;
  }
  const Solid solid = carve(packing, 0.01);
  for (std::size_t i = 1; i < packing.spheres.size(); ++i) {
    EXPECT_LT(bounding_box(void_surface(solid, i - 1)).upper.x, bounding_box(void_surface(solid, i)).lower.x);
  }
}

TEST(Carve, SameBytesForAnyThreadCount) {
  Packing packing;
  for (int i = 0; i < 300; ++i) {
    packing.spheres.push_back(ball({3.0 * (i % 10), 3.0 * (i / 10 % 10), 3.0 * (i / 100)}, 0.62 + 0.003 * i));
  }
  Solid first;
  for (const std::size_t threads : {1u, 2u, 8u}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Solid solid = carve(packing, 0.02);
    if (threads == 1) first = solid;
    EXPECT_EQ(solid.mesh.triangles, first.mesh.triangles) << threads << " threads";
    EXPECT_EQ(solid.mesh.positions, first.mesh.positions) << threads << " threads";
  }
}

TEST(Carve, SaysWhereSinglePrecisionIsTooCoarse) {
  Monitor monitor;
  EXPECT_THROW(carve(test::packing_of({ball({1e6, 0, 0}, 1)}), 0.05), UsageError);
  EXPECT_THROW(carve(test::packing_of({ball({100, 0, 0}, 1e-5)}), 0.05), UsageError);
  EXPECT_THROW(carve(test::packing_of({ball({100, 0, 0}, 1)}), 1e-5), UsageError);
}

TEST(Carve, RefusesAVoidOfMillionsOfTriangles) {
  EXPECT_THROW(estimate_void_triangles(test::packing_of({ball({0, 0, 0}, 100)}), {1e-4}), UsageError);
}

TEST(Carve, StopsWhenInterrupted) {
  class Interrupted : public Monitor {
   public:
    void check_interrupted() override { throw InterruptedError(); }
  } monitor;
  EXPECT_THROW(carve_keeping_surface({}, test::packing_of({ball({0, 0, 0}, 1)}), {}, monitor),
               InterruptedError);
}

TEST(Carve, EstimateIsExact) {
  const Packing packing =
      test::packing_of({ball({20, 20, 20}, 5), ball({70, 70, 70}, 1), ball({20, 70, 70}, 2)});
  for (const double tolerance : {0.3, 0.05, 0.01}) {
    EXPECT_EQ(estimate_void_triangles(packing, {tolerance}),
              carve(packing, tolerance).mesh.triangles.size() - 12);
    EXPECT_GE(most_void_triangles(packing, {tolerance}), estimate_void_triangles(packing, {tolerance}));
  }
  EXPECT_EQ(estimate_void_triangles({}, {}), 0);
}

TEST(Carve, FindsTheToleranceForATriangleBudget) {
  const Packing packing =
      test::packing_of({ball({20, 20, 20}, 5), ball({70, 70, 70}, 1), ball({20, 70, 70}, 2)});
  const CarveOptions options{0.03};
  const std::size_t finest = estimate_void_triangles(packing, options);
  const std::size_t coarsest = estimate_void_triangles(packing, {100});
  EXPECT_EQ(loosen_tolerance(packing, options, finest), options.tolerance);
  EXPECT_EQ(loosen_tolerance(packing, options, coarsest - 1), std::nullopt);
  for (const std::size_t budget : {coarsest, finest / 4, finest / 2, finest - 1}) {
    const std::optional<double> tolerance = loosen_tolerance(packing, options, budget);
    ASSERT_TRUE(tolerance) << budget;
    EXPECT_GT(*tolerance, options.tolerance);
    EXPECT_LE(estimate_void_triangles(packing, {*tolerance}), budget);
    EXPECT_GT(estimate_void_triangles(packing, {*tolerance / 1.02}), budget);
  }
}

TEST(Carve, ALooserToleranceNeverTakesMoreTriangles) {
  BallLadder ladder;
  std::size_t last = std::numeric_limits<std::size_t>::max();
  for (double tolerance = 0.002; tolerance < 5; tolerance *= 1.03) {
    const std::size_t count = ladder[ladder.level_for(ball({20, 20, 20}, 5), tolerance)].triangles.size();
    EXPECT_LE(count, last) << "tolerance " << tolerance;
    last = count;
  }
}

// The levels are the same for every model, so they are worth a look one by one.
TEST(BallLadder, EveryLevelIsAGoodTriangulation) {
  BallLadder ladder;
  std::set<std::size_t> levels;
  for (double tolerance = 0.2; tolerance > 1e-3; tolerance /= 1.05) {
    levels.insert(ladder.level_for(ball({0, 0, 0}, 1), tolerance));
  }
  EXPECT_GE(levels.size(), 40);
  for (const std::size_t level : levels) {
    SCOPED_TRACE("level " + std::to_string(level));
    const BallTemplate& made = ladder[level];
    Mesh mesh;
    mesh.triangles = made.triangles;
    for (const Vec3d& direction : made.directions) {
      EXPECT_NEAR(length(direction), 1, 1e-15);
      mesh.positions.push_back(to_float(direction));
    }
    EXPECT_TRUE(test::is_closed_manifold(mesh));
    EXPECT_EQ(test::euler_characteristic(mesh), 2);
    EXPECT_NEAR(made.volume_share * ball_volume(1), signed_volume(mesh), 1e-6);
    EXPECT_GE(made.volume_share, 0.9);
    // Triangle counts fall short of the ideal by no more than a half.
    EXPECT_LT(static_cast<double>(made.triangles.size()) * made.sagitta, 1.5 * kIdealTriangles);
    EXPECT_NEAR(test::deviation_from(mesh, ball({0, 0, 0}, 1)).lowest, -made.sagitta, 1e-6);
  }
}

TEST(ProjectOntoBall, RefusesWhatIsNoSphere) {
  const Mesh box = test::make_box({-1, -1, -1}, {1, 1, 1});
  EXPECT_TRUE(project_onto_ball(box, {0.1, 0.2, 0.3}));
  EXPECT_FALSE(project_onto_ball(test::turned_inside_out(box), {0, 0, 0}));
  EXPECT_FALSE(project_onto_ball(box, {3, 0, 0})) << "the centre is outside";
  EXPECT_FALSE(project_onto_ball(test::join(box, box), {0, 0, 0})) << "two shells";
  EXPECT_FALSE(project_onto_ball({}, {0, 0, 0}));
  Mesh open = box;
  open.triangles.pop_back();
  EXPECT_FALSE(project_onto_ball(open, {0, 0, 0}));
  Mesh misoriented = box;
  std::swap(misoriented.triangles[3][0], misoriented.triangles[3][1]);
  EXPECT_FALSE(project_onto_ball(misoriented, {0, 0, 0}));
}

}  // namespace
}  // namespace aerate
