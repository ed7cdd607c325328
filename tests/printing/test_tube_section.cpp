#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "core/overhang.h"
#include "printing/cells/tube_section.h"

namespace aerate {
namespace {

constexpr std::size_t kSides = 40;

Roof roof_of(double degrees, double bridge) {
  return make_roof({.degrees = degrees, .bridge = bridge, .up = {0, 0, 1}});
}

// Of the circle.
double share_of_area(const std::vector<Vec3d>& ring, const Tube& tube) {
  const Vec3d axis = direction_of(tube);
  double doubled = 0;
  for (std::size_t i = 0; i < ring.size(); ++i)
    doubled += dot(cross(ring[i] - tube.start, ring[(i + 1) % ring.size()] - tube.start), axis);
  return doubled / 2 / (std::numbers::pi * tube.radius * tube.radius);
}

// How wide, across the axis, sides are together that lean by more than so much.
double width_of_ceiling(const std::vector<Vec3d>& ring, const Tube& tube, double degrees) {
  const Vec3d axis = direction_of(tube), across = frame_of(tube, {0, 0, 1}).across;
  double width = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3d side = ring[(i + 1) % ring.size()] - ring[i];
    const Vec3d outward = normalised(cross(side, axis));
    const double lean = std::asin(std::min(1.0, outward.z)) * 180 / std::numbers::pi;
    if (lean > degrees + 1e-6) width += std::abs(dot(side, across));
  }
  return width;
}

void expect_sound(const std::vector<Vec3d>& ring, const Tube& tube, const Roof& roof) {
  const Vec3d axis = direction_of(tube);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3d a = ring[i] - tube.start, b = ring[(i + 1) % ring.size()] - tube.start,
                c = ring[(i + 2) % ring.size()] - tube.start;
    EXPECT_NEAR(length(a), tube.radius, 1e-9);
    EXPECT_NEAR(dot(a, axis), 0, 1e-9);
    EXPECT_GT(dot(cross(a, b), axis), 0);
    EXPECT_GT(dot(cross(b - a, c - b), axis), 0);
  }
  if (!roof.limits_ceilings()) return;
  EXPECT_LE(width_of_ceiling(ring, tube, overhang_degrees(roof)), roof.bridge() + 1e-6);
}

}  // namespace

TEST(TubeSection, ALevelTubeHasATopThatIsBridged) {
  const Tube tube{{1, 2, 3}, {11, 2, 3}, 2.5};
  const Roof roof = roof_of(45, 2);
  const std::vector<Vec3d> ring = tube_section(tube, roof, kSides, 0);
  expect_sound(ring, tube, roof);
  EXPECT_NEAR(width_of_ceiling(ring, tube, 45), 2, 1e-6);
  // The segments beyond the two chords: 2.2 % of the circle; and what the polygon leaves of it.
  EXPECT_NEAR(share_of_area(ring, tube), 0.975, 0.005);
}

TEST(TubeSection, OfManyTubesNoCeilingIsWiderThanTheBridge) {
  for (const double degrees : {30.0, 45.0, 60.0}) {
    for (const double bridge : {0.5, 2.0, 5.0}) {
      const Roof roof = roof_of(degrees, bridge);
      for (const double rise : {-0.95, -0.6, 0.0, 0.3, 0.8, 1.0}) {
        for (const double turn : {0.0, 0.382, 0.764, 1.146, 1.91}) {
          const double aside = std::sqrt(1 - rise * rise);
          const Tube tube{{0, 0, 0}, Vec3d{aside * 0.8, aside * 0.6, rise} * 7.0, 1.75};
          SCOPED_TRACE(testing::Message() << degrees << ' ' << bridge << ' ' << rise << ' ' << turn);
          const std::vector<Vec3d> ring = tube_section(tube, roof, kSides, turn);
          expect_sound(ring, tube, roof);
          EXPECT_GT(share_of_area(ring, tube), 0.7);
        }
      }
    }
  }
}

TEST(TubeSection, IsARegularPolygonWhereCeilingsAreNotLimited) {
  const Tube tube{{0, 0, 0}, {4, 0, 0}, 1};
  const std::vector<Vec3d> ring = tube_section(tube, Roof{}, 12, 0);
  ASSERT_EQ(ring.size(), 12U);
  expect_sound(ring, tube, Roof{});
  for (std::size_t i = 0; i < ring.size(); ++i)
    EXPECT_NEAR(length(ring[(i + 1) % ring.size()] - ring[i]), 2 * std::sin(std::numbers::pi / 12), 1e-9);
}

TEST(TubeSection, AnotherTurnIsAnotherPolygon) {
  const Tube tube{{0, 0, 0}, {4, 0, 0}, 2.5};
  const Roof roof = roof_of(45, 2);
  EXPECT_NE(tube_section(tube, roof, kSides, 0), tube_section(tube, roof, kSides, 0.382));
}

}  // namespace aerate
