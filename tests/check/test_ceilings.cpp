#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "check/ceilings.h"
#include "core/overhang.h"
#include "core/upright.h"
#include "printing/carve.h"
#include "tests/support/closed_shells.h"
#include "tests/support/packing_of.h"
#include "tests/support/shapes.h"

// Ceilings of voids, measured on their triangles.
namespace aerate {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Ceilings measure(const Mesh& inward, const Roof& roof) {
  const SolidPart whole{PartKind::void_surface, 0, inward.triangles.size()};
  Monitor monitor;
  return measure_ceilings(inward, std::vector{whole}, roof, monitor);
}

Mesh hole(Vec3f lower, Vec3f upper) {
  return test::turned_inside_out(test::make_box(lower, upper));
}

Ceilings measure_carved(const Sphere& sphere, const Roof& carved, const Roof& roof, double tolerance) {
  Monitor monitor;
  const Solid solid = carve_keeping_surface(test::make_box({-50, -50, -50}, {50, 50, 50}),
                                            test::packing_of({sphere}, carved), {tolerance}, monitor);
  return measure_ceilings(solid.mesh, solid.of(PartKind::void_surface), roof, monitor);
}

TEST(Ceilings, OfABoxIsAsWideAsItsShorterSideWhateverIsUp) {
  const Mesh box = hole({1, 2, 3}, {11, 22, 7});
  for (const double sign : {1.0, -1.0}) {
    EXPECT_NEAR(measure(box, make_roof({.up = {0, 0, sign}})).widest, 10, 1e-3);
    EXPECT_NEAR(measure(box, make_roof({.up = {0, sign, 0}})).widest, 4, 1e-3);
    EXPECT_NEAR(measure(box, make_roof({.up = {sign, 0, 0}})).widest, 4, 1e-3);
  }
  EXPECT_EQ(measure(box, make_roof({})).count, 1U);
  // Solid that faces outward has its ceiling below: what looks down.
  EXPECT_EQ(measure(test::make_box({1, 2, 3}, {11, 22, 7}), make_roof({})).count, 1U);
}

TEST(Ceilings, BeginFiveDegreesBeyondTheOverhangAndAreSeenAlongUp) {
  // The box's lid leans by 90 - tilt degrees, one of its sides by tilt; both are shorter as seen from below.
  for (const double tilt : {35.0, 39.0, 41.0, 48.0, 55.0}) {
    const Roof roof = make_roof({.up = {std::sin(tilt * kDegree), 0, std::cos(tilt * kDegree)}});
    const Ceilings ceilings = measure(hole({0, 0, 0}, {10, 30, 30}), roof);
    const bool lid = 90 - tilt > 50, side = tilt > 50;
    EXPECT_EQ(ceilings.count, (lid ? 1U : 0U) + (side ? 1U : 0U)) << tilt;
    EXPECT_NEAR(ceilings.widest,
                lid    ? 10 * std::cos(tilt * kDegree)
                : side ? 30 * std::sin(tilt * kDegree)
                       : 0.0,
                1e-3)
        << tilt;
  }
}

TEST(Ceilings, OfASphereIsItsCap) {
  const Sphere sphere{{1, 2, 3}, 9.5, SphereKind::adaptive};
  const double cap = 2 * 9.5 * std::cos(50 * kDegree);
  EXPECT_NEAR(measure_carved(sphere, {}, make_roof({}), 0.002).widest, cap, 0.25);
  // A rule that nothing can break.
  EXPECT_EQ(measure_carved(sphere, {}, make_roof({.degrees = 86}), 0.05).count, 0U);
}

TEST(Ceilings, OfVoidsWithRoofsAreNoWiderThanTheBridge) {
  for (const Overhang& overhang :
       {Overhang{}, Overhang{.degrees = 30, .bridge = 2, .up = {0, -1, 0}},
        Overhang{.degrees = 60, .bridge = 8, .up = {1, -2, 0.5}}, Overhang{.bridge = 0}}) {
    const Roof roof = make_roof(overhang);
    for (const double radius : {1.0, 3.5, 3.6, 4.5, 9.5}) {
      for (const double tolerance : {0.02, 0.05, 0.3}) {
        const Sphere sphere{{1, 2, 3}, radius, SphereKind::adaptive};
        const double widest = measure_carved(sphere, roof, roof, tolerance).widest;
        EXPECT_LE(widest, overhang.bridge + tolerance) << overhang.degrees << " " << radius;
        if (radius == 9.5 && tolerance < 0.1) {
          EXPECT_GE(widest, 0.97 * overhang.bridge);
        }
      }
    }
  }
}

TEST(Ceilings, AreTheWidestOfAll) {
  Mesh boxes = hole({0, 0, 0}, {3, 9, 3});
  std::vector<SolidPart> voids{{PartKind::void_surface, 0, 12}};
  for (const float width : {7.0F, 5.0F}) {
    const Mesh other = hole({20 * width, 0, 0}, {21 * width, width, 3});
    voids.push_back({PartKind::void_surface, boxes.triangles.size(), 12});
    const auto first = static_cast<std::uint32_t>(boxes.positions.size());
    boxes.positions.insert(boxes.positions.end(), other.positions.begin(), other.positions.end());
    for (const Triangle& t : other.triangles)
      boxes.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  Monitor monitor;
  const Ceilings ceilings = measure_ceilings(boxes, voids, make_roof({}), monitor);
  EXPECT_EQ(ceilings.count, 3U);
  EXPECT_NEAR(ceilings.widest, 7, 1e-3);
}

TEST(UprightFrame, IsRightHandedAndTheModelsOwnForZ) {
  EXPECT_TRUE(UprightFrame({0, 0, 1}).is_the_models_own());
  EXPECT_EQ(UprightFrame({0, 0, 1}).to_frame({1, 2, 3}), (Vec3d{1, 2, 3}));
  for (const Vec3d up : {Vec3d{0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {0.6, 0, 0.8}}) {
    const UprightFrame frame(up);
    EXPECT_NEAR(dot(cross(frame.x, frame.y), frame.z), 1, 1e-12);
    EXPECT_NEAR(frame.to_frame(up).z, 1, 1e-12);
    const Mesh box = test::make_box({1, 2, 3}, {4, 6, 8});
    EXPECT_NEAR(signed_volume(turned_upright(box, frame)), 60, 1e-4);
  }
}

}  // namespace
}  // namespace aerate
