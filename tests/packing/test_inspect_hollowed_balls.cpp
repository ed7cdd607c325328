#include <gtest/gtest.h>
#include <numbers>

#include "packing/air/inspect_drainage.h"
#include "tests/support/implicit_mesh.h"

namespace aerate::test {
namespace {

// A ball of 17 mm hollowed to a wall of 2 mm, with round holes of 3.5 mm along the axes.
constexpr double kInner = 15, kOuter = 17, kHoleRadius = 1.75;
constexpr double kHollow = 4.0 / 3 * std::numbers::pi * kInner * kInner * kInner;

Implicit shell() {
  return without(ball({0, 0, 0}, kOuter), ball({0, 0, 0}, kInner));
}
Implicit hole_along(Vec3d direction) {
  return rod(direction * 10, direction * 20, kHoleRadius);
}
Mesh meshed(const Implicit& solid) {
  return mesh_of(solid, 18, 0.5);
}

InspectedDrainage look_at(const Mesh& model, Vec3d up = {0, 0, 1}) {
  Monitor monitor;
  return inspect_drainage(model, {.up = up, .widest_hole = 7}, monitor);
}

// Of the hollow, what is below a height.
double below(double height) {
  const double depth = height + kInner;
  return std::numbers::pi * depth * depth * (3 * kInner - depth) / 3;
}

constexpr double kOnePercent = 0.01 * kHollow;

TEST(InspectHollowedBalls, HolesLowAndHighDrain) {
  const Implicit solid = without(without(shell(), hole_along({0, 0, -1})), hole_along({0, 0, 1}));
  const InspectedDrainage found = look_at(meshed(solid));
  ASSERT_EQ(found.found.hollows.size(), 1U);
  EXPECT_NEAR(found.found.hollows.front().volume, kHollow, kOnePercent);
  ASSERT_EQ(found.found.holes.size(), 2U);
  for (const FoundHole& hole : found.found.holes) {
    EXPECT_NEAR(hole.width, 2 * kHoleRadius, 0.2);
    EXPECT_NEAR(std::abs(hole.place.z), 16, 0.7);
    EXPECT_NEAR(std::hypot(hole.place.x, hole.place.y), 0, 0.2);
  }
  EXPECT_LT(found.pools.upright, 0.001 * kHollow);
  EXPECT_LT(found.pools.upside_down, 0.001 * kHollow);
  EXPECT_LT(found.pools.after_both, 0.001 * kHollow);
  EXPECT_TRUE(found.cups.empty() || found.cups.front().area < 2);
  ASSERT_TRUE(found.found.wall.has_value());
  EXPECT_NEAR(found.found.wall->thickness, kOuter - kInner, 0.03);
}

TEST(InspectHollowedBalls, AHoleAtTheTopAloneKeepsAllOfItAsPrinted) {
  const InspectedDrainage found = look_at(meshed(without(shell(), hole_along({0, 0, 1}))));
  EXPECT_NEAR(found.pools.upright, kHollow, kOnePercent);
  EXPECT_LT(found.pools.upside_down, 0.001 * kHollow);
  ASSERT_FALSE(found.cups.empty());
  const double widest = std::numbers::pi * kInner * kInner;
  EXPECT_NEAR(found.cups.front().area, widest, 0.01 * widest);
  EXPECT_NEAR(found.cups.front().height, kOuter, 1);
  EXPECT_NEAR(found.cups.front().bottom.z, -kInner, 0.05);
}

TEST(InspectHollowedBalls, AHoleInTheMiddleLeavesWhatIsBelowItsLowestPoint) {
  const InspectedDrainage found = look_at(meshed(without(shell(), hole_along({1, 0, 0}))));
  EXPECT_NEAR(found.pools.upright, below(-kHoleRadius), kOnePercent);
  EXPECT_NEAR(found.pools.upside_down, below(-kHoleRadius), kOnePercent);
  EXPECT_NEAR(found.pools.after_both, below(-kHoleRadius), kOnePercent);
  ASSERT_FALSE(found.cups.empty());
  EXPECT_NEAR(found.cups.front().height, kOuter - kHoleRadius, 0.15);
}

// The hole's axis leans from up by t: its lowest point inside is at cos(a + t) of the inner radius, where a is half the angle
// that the hole takes of it.
TEST(InspectHollowedBalls, SeenAlongAnotherUpTheHoleIsAsHighAsItLies) {
  const Vec3d up = normalised(Vec3d{1, 2, 3});
  const InspectedDrainage found = look_at(meshed(without(shell(), hole_along({0, 0, 1}))), up);
  const double lean = std::acos(up.z), half = std::asin(kHoleRadius / kInner);
  // On the way out the tube rises: what is lowest is its outer rim's lowest point if that is higher.
  const double sill =
      std::max(kInner * std::cos(lean + half), kOuter * std::cos(lean + std::asin(kHoleRadius / kOuter)));
  EXPECT_NEAR(found.pools.upright, below(sill), kOnePercent);
  EXPECT_NEAR(found.pools.upside_down, below(-kInner * std::cos(half - lean)), kOnePercent);
}

TEST(InspectHollowedBalls, AHoleThatMissesTheHollowOnlyDentsItsWall) {
  const InspectedDrainage found =
      look_at(meshed(without(shell(), rod({0, 0, -20}, {0, 0, -16}, kHoleRadius))));
  ASSERT_EQ(found.found.hollows.size(), 1U);
  EXPECT_TRUE(found.found.hollows.front().is_sealed);
  EXPECT_TRUE(found.found.holes.empty());
  ASSERT_TRUE(found.found.wall.has_value());
  EXPECT_NEAR(found.found.wall->thickness, 1, 0.05);
  EXPECT_NEAR(found.found.wall->place.z, -kInner, 0.1);
}

TEST(InspectHollowedBalls, ASealedOneIsSealed) {
  const InspectedDrainage found = look_at(meshed(shell()));
  ASSERT_EQ(found.found.hollows.size(), 1U);
  EXPECT_TRUE(found.found.hollows.front().is_sealed);
  EXPECT_NEAR(found.found.hollows.front().volume, kHollow, kOnePercent);
}

// A bowl is no hollow: a ball gets in. It holds a pool, and sucks while it is printed that way up.
TEST(InspectHollowedBalls, ABowlIsARecessThatHoldsAPoolAndACup) {
  const Mesh bowl = meshed(without(shell(), rod({0, 0, 0}, {0, 0, 30}, 30)));
  const InspectedDrainage found = look_at(bowl);
  EXPECT_TRUE(found.found.hollows.empty());
  EXPECT_NEAR(found.recesses_upright, kHollow / 2, kOnePercent);
  EXPECT_EQ(found.recesses_upside_down, 0);
  ASSERT_FALSE(found.cups.empty());
  EXPECT_NEAR(found.cups.front().volume, kHollow / 2, kOnePercent);

  const InspectedDrainage turned = look_at(bowl, {0, 0, -1});
  EXPECT_EQ(turned.recesses_upright, 0);
  EXPECT_TRUE(turned.cups.empty());
}

}  // namespace
}  // namespace aerate::test
