#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <optional>
#include <set>
#include <tbb/global_control.h>
#include <vector>

#include "check/same_triangles.h"
#include "core/overhang.h"
#include "core/void_shape.h"
#include "printing/ball_template.h"
#include "printing/carve_drained.h"
#include "printing/cut_surface.h"
#include "printing/open_ball.h"
#include "tests/support/caught.h"
#include "tests/support/closed_shells.h"
#include "tests/support/packing_of.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

constexpr Vec3d kUp{0, 0, 1};
constexpr double kTolerance = 0.05;

Sphere ball(Vec3d centre, double radius) {
  return {centre, radius, SphereKind::adaptive};
}

// Two voids in a block, a channel that is off both centres, a hole below and one to the side.
class CarveDrained : public testing::Test {
 protected:
  CarveDrained() {
    plan_.channels.push_back({0, 1, between({12, 15, 12}, {26, 15, 15}, 2)});
    plan_.holes.push_back({0, out_of({12, 14, 10}, {0, 0, -1}, 2), 0});
    plan_.holes.push_back({1, out_of({28, 15, 14}, {1, 0, 0.2}, 2), 0});
    plan_.network_count = 1;
  }

  // The parts of the lines outside the voids, generously: they begin inside the surface's own curve.
  Tube between(Vec3d from, Vec3d to, double radius) const {
    const Vec3d axis = (to - from) * (1 / length(to - from));
    return {from + axis * leaves(spheres_[0], from, axis, radius),
            to - axis * leaves(spheres_[1], to, axis * -1, radius), radius};
  }
  Tube out_of(Vec3d from, Vec3d direction, double radius) const {
    const Vec3d axis = direction * (1 / length(direction));
    const Sphere& sphere = axis.z < 0 ? spheres_[0] : spheres_[1];
    const double to_surface = axis.z < 0 ? from.z / -axis.z : (40 - from.x) / axis.x;
    return {from + axis * leaves(sphere, from, axis, radius), from + axis * to_surface, radius};
  }
  // Least way from a point inside a ball to where a tube's lines leave it.
  static double leaves(const Sphere& sphere, Vec3d from, Vec3d axis, double radius) {
    const Vec3d to_centre = sphere.centre - from;
    const double along = dot(to_centre, axis);
    const double off = length(to_centre - axis * along) + radius;
    return along + std::sqrt(sphere.radius * sphere.radius - off * off);
  }

  Solid carve(double tolerance = kTolerance) const {
    Monitor silent;
    return carve_drained(model_, SurfaceIndex(model_), packing_, plan_, {.tolerance = tolerance}, silent);
  }
  std::optional<std::size_t> first_uncut(const Mesh& model) const {
    Monitor silent;
    const auto cut =
        cut_holes(model, SurfaceIndex(model), packing_, plan_, {.tolerance = kTolerance}, silent);
    const auto* const uncut = std::get_if<UncutHoles>(&cut);
    return uncut != nullptr ? std::optional(uncut->indices.front()) : std::nullopt;
  }

  Mesh model_ = test::make_box({0, 0, 0}, {40, 30, 30});
  Packing packing_ = test::packing_of({ball({12, 15, 12}, 7), ball({28, 15, 14}, 6)});
  std::vector<Sphere>& spheres_ = packing_.spheres;
  Roof& roof_ = packing_.limits.roof;
  DrainagePlan plan_;
};

TEST_F(CarveDrained, TheResultIsOneClosedSurfaceOfTheRightGenus) {
  const Solid solid = carve();
  ASSERT_TRUE(test::is_closed_manifold(solid.mesh));
  // A block with one tunnel through both voids: a torus.
  EXPECT_EQ(test::euler_characteristic(solid.mesh), 2 + 2 * 2 - 3 * 2);
  EXPECT_GT(signed_volume(solid.mesh), 0);
}

TEST_F(CarveDrained, WhatIsRemovedIsWhatWasPlanned) {
  const auto ball_volume = [](double r) { return 4.0 / 3.0 * std::numbers::pi * r * r * r; };
  const double removed = signed_volume(model_) - signed_volume(carve(0.005).mesh);
  double tubes = 0;
  for (const Channel& c : plan_.channels) tubes += length(c.tube.end - c.tube.start);
  for (const EscapeHole& hole : plan_.holes) tubes += length(hole.tube.end - hole.tube.start);
  const double balls = ball_volume(7) + ball_volume(6);
  EXPECT_LT(removed, balls + tubes * std::numbers::pi * 4);
  // The tubes overlap the balls by their caps alone, each less than a slice as thick as it sags.
  EXPECT_GT(removed, balls * 0.995 + (tubes - 4 * 0.4) * std::numbers::pi * 4 * 0.99);
}

TEST_F(CarveDrained, TheOuterSurfaceIsCutAtTheHolesAlone) {
  const Solid solid = carve();
  const std::size_t kept = solid.of(PartKind::outer).front().triangle_count;
  EXPECT_GE(kept, model_.triangles.size() - 4);
  EXPECT_LE(kept, model_.triangles.size() - 2);
  // Those that are kept are the model's, in their order.
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < model_.triangles.size() && next < kept; ++i)
    next += has_same_corners(solid.mesh, next, model_, i) ? 1U : 0U;
  EXPECT_EQ(next, kept);
  // What is left of the two faces has their area less that of the holes.
  double area = 0;
  for (std::size_t i = 0; i < solid.outer_triangle_count(); ++i) {
    const Triangle& t = solid.mesh.triangles[i];
    const Vec3d a = to_double(solid.mesh.positions[t[0]]);
    area +=
        length(cross(to_double(solid.mesh.positions[t[1]]) - a, to_double(solid.mesh.positions[t[2]]) - a)) /
        2;
  }
  const double slope = std::sqrt(1.04);  // the hole to the side is an ellipse
  EXPECT_NEAR(area, 2 * (40 * 30 + 40 * 30 + 30 * 30) - std::numbers::pi * 4 * (1 + slope), 0.4);
}

TEST_F(CarveDrained, EveryPartStaysInsideItsShapeByTheToleranceAtMost) {
  for (const double tolerance : {0.2, 0.05, 0.01}) {
    const Solid solid = carve(tolerance);
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
      const Sphere& sphere = spheres_[i];
      for (const Triangle& t : triangles_of(solid.mesh, solid.of(PartKind::void_surface)[i])) {
        const Vec3d a = to_double(solid.mesh.positions[t[0]]) - sphere.centre;
        const Vec3d b = to_double(solid.mesh.positions[t[1]]) - sphere.centre;
        const Vec3d c = to_double(solid.mesh.positions[t[2]]) - sphere.centre;
        const Vec3d normal = cross(b - a, c - a);
        EXPECT_LE(std::max({length(a), length(b), length(c)}), sphere.radius);
        EXPECT_GE(-dot(normal, a) / length(normal), sphere.radius - tolerance);
      }
    }
  }
}

// Both voids with roofs: they end in a flat top as wide as the bridge, and tubes open below.
TEST_F(CarveDrained, VoidsWithRoofs) {
  roof_ = make_roof({.degrees = 45, .bridge = 2, .up = kUp});
  plan_.holes[1].tube = out_of({28, 15, 12}, {1, 0, 0}, 2);
  for (const Channel& c : plan_.channels) {
    ASSERT_TRUE(VoidShape(spheres_[0], roof_).opens_below_roof(c.tube, TubeEnd::start));
    ASSERT_TRUE(VoidShape(spheres_[1], roof_).opens_below_roof(c.tube, TubeEnd::end));
  }
  for (const double tolerance : {0.2, 0.05, 0.02}) {
    const Solid solid = carve(tolerance);
    ASSERT_TRUE(test::is_closed_manifold(solid.mesh));
    EXPECT_EQ(test::euler_characteristic(solid.mesh), 2 + 2 * 2 - 3 * 2);
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
      double top = 0;
      for (const Triangle& t : triangles_of(solid.mesh, solid.of(PartKind::void_surface)[i])) {
        for (const std::uint32_t v : t) {
          const Vec3d p = to_double(solid.mesh.positions[v]);
          EXPECT_LE(least_radius_holding(roof_, spheres_[i].centre, p), spheres_[i].radius);
          top = std::max(top, p.z - spheres_[i].centre.z);
        }
      }
      EXPECT_NEAR(top, roof_.top(spheres_[i].radius), tolerance);
    }
  }
  const double removed = signed_volume(model_) - signed_volume(carve(0.02).mesh);
  roof_ = {};
  const double without = signed_volume(model_) - signed_volume(carve(0.02).mesh);
  const Roof roof = make_roof({.degrees = 45, .bridge = 2, .up = kUp});
  EXPECT_NEAR(removed - without,
              void_volume(roof, 7) + void_volume(roof, 6) - void_volume({}, 7) - void_volume({}, 6), 4);
}

// A channel that takes the place of the lower void's flat top.
TEST_F(CarveDrained, AChannelOutOfARoof) {
  roof_ = make_roof({.degrees = 45, .bridge = 2, .up = kUp});
  model_ = test::make_box({0, 0, 0}, {30, 30, 50});
  spheres_ = {ball({15, 15, 12}, 6), ball({16, 14, 31}, 5)};
  const Vec3d start = spheres_[0].centre + kUp * VoidShape(spheres_[0], roof_).top_opening_height(1.4);
  plan_.channels = {{0, 1, {start, {15, 15, 26.5}, 1.4}}};
  ASSERT_TRUE(VoidShape(spheres_[0], roof_).comes_out_of_top(plan_.channels[0].tube));
  plan_.holes = {{0, {{15, 15, 6.5}, {15, 15, 0}, 2}, 0}, {1, {{20, 14, 30}, {30, 14, 30}, 1.5}, 0}};
  for (const double tolerance : {0.2, 0.05}) {
    const Solid solid = carve(tolerance);
    ASSERT_TRUE(test::is_closed_manifold(solid.mesh));
    EXPECT_EQ(test::euler_characteristic(solid.mesh), 2 + 2 * 2 - 3 * 2);
    // The cone ends at the channel, which no triangle closes.
    for (const Triangle& t : triangles_of(solid.mesh, solid.of(PartKind::void_surface)[0])) {
      for (const std::uint32_t v : t) EXPECT_LE(solid.mesh.positions[v].z, start.z);
    }
  }
}

TEST_F(CarveDrained, ASideThatATubeMeetsAtAGrazingAngle) {
  // As far off the centre as may be.
  const double off = 0.999 * kWidestTubeShare * 7 - 2;
  plan_.holes[0].tube = out_of({12, 15 - off, 10}, {0, 0, -1}, 2);
  ASSERT_TRUE(VoidShape(spheres_[0], {}).crossing(plan_.holes[0].tube, TubeEnd::start));
  for (const double tolerance : {0.2, 0.05, 0.01})
    EXPECT_TRUE(test::is_closed_manifold(carve(tolerance).mesh));
}

TEST_F(CarveDrained, TheSameBytesForAnyNumberOfThreads) {
  const Solid reference = carve();
  for (const std::size_t threads : {1U, 2U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Solid solid = carve();
    EXPECT_EQ(solid.mesh.triangles, reference.mesh.triangles);
    EXPECT_EQ(solid.mesh.positions, reference.mesh.positions);
  }
}

TEST_F(CarveDrained, AHoleIsNotCutWhereTheSurfaceIsNoSinglePiece) {
  const WayOut way{plan_.holes[0].tube, spheres_[0]};
  EXPECT_TRUE(may_be_cut(model_, SurfaceIndex(model_), way, Roof{}, kTolerance));
  EXPECT_EQ(first_uncut(model_), std::nullopt);
  // Another surface a little below the first.
  const Mesh doubled = test::join(model_, test::make_box({0, 0, -3}, {40, 30, -2}));
  EXPECT_FALSE(may_be_cut(doubled, SurfaceIndex(doubled), way, Roof{}, kTolerance));
  EXPECT_EQ(first_uncut(doubled), 0);
  // It stops short of the surface.
  const Mesh larger = test::make_box({0, 0, -20}, {40, 30, 30});
  EXPECT_FALSE(may_be_cut(larger, SurfaceIndex(larger), way, Roof{}, kTolerance));
  EXPECT_EQ(first_uncut(larger), 0);
  model_ = larger;
  EXPECT_TRUE(test::contains(test::message_of<FailureError>([this] { carve(); }), "cannot be cut"));
}

StarTriangulation template_of(const Sphere& sphere, double tolerance) {
  BallLadder ladder;
  const BallTemplate& ball = ladder[ladder.level_for(sphere, tolerance)];
  StarTriangulation whole(ball.directions, ball.triangles);
  EXPECT_TRUE(whole.connect());
  return whole;
}

// The hull by brute force: no point is beyond the plane of any triangle, and what is open are the rims.
TEST(OpenBall, IsTheHullLessWhatIsInsideTheRims) {
  const Sphere sphere{{3, -2, 7}, 5, SphereKind::adaptive};
  for (const double tolerance : {0.3, 0.05, 0.01}) {
    const StarTriangulation whole = template_of(sphere, tolerance);
    std::vector<Opening> openings;
    for (const Vec3d direction : {Vec3d{0, 0, 1}, Vec3d{0.6, 0, -0.8}, Vec3d{-0.48, 0.6, -0.64}}) {
      const Vec3d inside = sphere.centre + Vec3d{0.4, 0.3, 0.2};
      const Tube tube{inside, inside + direction * 9, 1.2};
      openings.push_back({tube, TubeEnd::start, VoidShape(sphere, {}).rim(tube, TubeEnd::start, 32)});
    }
    const auto opened = open_ball(sphere, whole, openings);
    ASSERT_TRUE(opened) << tolerance;
    ASSERT_GT(opened->positions.size(), 3 * 32 + (tolerance < 0.1 ? 100U : 0U));
    std::set<std::array<std::uint32_t, 2>> sides;
    for (const Triangle& t : opened->triangles) {
      const Vec3d a = opened->positions[t[0]];
      Vec3d normal = cross(opened->positions[t[1]] - a, opened->positions[t[2]] - a);
      normal = normal * (1 / length(normal));
      EXPECT_GE(dot(normal, a - sphere.centre), opened->nearest);
      for (const Vec3d p : opened->positions) ASSERT_LT(dot(normal, p - a), 1e-8);
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_TRUE(sides.insert({t[k], t[(k + 1) % 3]}).second) << "a side that two triangles share";
    }
    std::size_t open = 0;
    for (const auto& [from, to] : sides) {
      if (sides.contains({to, from})) continue;
      ++open;
      EXPECT_TRUE(from < 96 && to < 96 && from / 32 == to / 32 && from % 32 == (to + 1) % 32)
          << from << " -> " << to;
    }
    EXPECT_EQ(open, 96);
  }
}

// The circle of a roof at an overhang of 15 degrees: near the equator, where many points are as far from the
// axis.
TEST(OpenBall, ARimNearTheEquatorLeavesWhatIsBeyondIt) {
  const Sphere sphere{{0, 0, 0}, 8, SphereKind::adaptive};
  const StarTriangulation whole = template_of(sphere, 0.05);
  const Tube tube{{0, 0, 0}, {0, 0, 1}, 8 * std::cos(15 * std::numbers::pi / 180)};
  const std::vector<Opening> openings{
      {tube, TubeEnd::start, VoidShape(sphere, {}).rim(tube, TubeEnd::start, 200)}};
  const auto opened = open_ball(sphere, whole, openings);
  ASSERT_TRUE(opened);
  EXPECT_GE(opened->nearest, 8 - 0.06);
}

TEST(OpenBall, RefusesOpeningsThatMeet) {
  const Sphere sphere{{0, 0, 0}, 5, SphereKind::adaptive};
  const StarTriangulation whole = template_of(sphere, 0.05);
  std::vector<Opening> openings;
  for (const double x : {0.0, 1.0}) {
    const Tube tube{{x, 0, 0}, {x, 0, 9}, 1.2};
    openings.push_back({tube, TubeEnd::start, VoidShape(sphere, {}).rim(tube, TubeEnd::start, 32)});
  }
  EXPECT_FALSE(open_ball(sphere, whole, openings));
  openings.pop_back();
  EXPECT_TRUE(open_ball(sphere, whole, openings));
}

// Both holes come out of one triangle: the second meets what the first has left of it.
TEST_F(CarveDrained, TwoHolesThroughOneTriangle) {
  plan_.holes[1].tube = {{27, 15, 8.9}, {27, 15, 0}, 2};
  ASSERT_EQ(first_uncut(model_), std::nullopt);
  const Solid solid = carve();
  EXPECT_TRUE(test::is_closed_manifold(solid.mesh));
  EXPECT_GE(solid.of(PartKind::outer).front().triangle_count, model_.triangles.size() - 2);
  // A hole where there is one already.
  plan_.holes.push_back(plan_.holes[0]);
  EXPECT_EQ(first_uncut(model_), 2);
}

}  // namespace
}  // namespace aerate
