#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "packing/air/inspect_drainage.h"
#include "tests/support/hollow_boxes.h"
#include "tests/support/shapes.h"

namespace aerate::test {
namespace {

constexpr double kWidestHole = 7;

InspectedDrainage look_at(const Mesh& model, Vec3d up = {0, 0, 1}) {
  Monitor monitor;
  return inspect_drainage(model, {.up = up, .widest_hole = kWidestHole}, monitor);
}

// Walls that are level with the grid's axes put a whole row of columns in or out: a spacing on each side.
void expect_volume(double found, double expected, double spacing) {
  EXPECT_NEAR(found, expected, 2 * spacing / 30 * expected + 1);
}

// Below the sill of a hole in the middle of a side stands what is up to 13 mm above the floor.
constexpr double kBelowSideHole = 30.0 * 30 * 13;

TEST(InspectDrainage, ABoxWithHolesInBottomAndTopDrains) {
  const InspectedDrainage found = look_at(hollow_box({BoxHole::bottom, BoxHole::top}));
  ASSERT_EQ(found.found.hollows.size(), 1U);
  EXPECT_FALSE(found.found.hollows.front().is_sealed);
  expect_volume(found.found.hollows.front().volume, kHollowOfBox, found.spacing);
  ASSERT_EQ(found.found.holes.size(), 2U);
  for (const FoundHole& hole : found.found.holes) {
    EXPECT_NEAR(hole.width, 4, 0.1);
    EXPECT_NEAR(hole.place.x, 17, 0.1);
    EXPECT_NEAR(hole.place.y, 17, 0.1);
  }
  EXPECT_LT(found.pools.upright, 1);
  EXPECT_LT(found.pools.upside_down, 1);
  EXPECT_TRUE(found.cups.empty());
  ASSERT_TRUE(found.found.wall.has_value());
  EXPECT_NEAR(found.found.wall->thickness, 2, 1e-3);
}

TEST(InspectDrainage, WithAHoleInTheTopAloneAllStaysUntilItIsTurnedAndTheWholeWidthSucks) {
  const InspectedDrainage found = look_at(hollow_box({BoxHole::top}));
  EXPECT_EQ(found.found.holes.size(), 1U);
  expect_volume(found.pools.upright, kHollowOfBox, found.spacing);
  EXPECT_LT(found.pools.upside_down, 1);
  EXPECT_LT(found.pools.after_both, 1);
  ASSERT_FALSE(found.cups.empty());
  const AirCup& cup = found.cups.front();
  expect_volume(cup.area, 900, found.spacing);
  expect_volume(cup.volume, kHollowOfBox, found.spacing);
  EXPECT_NEAR(cup.height, 32, 0.11);  // two layers
  EXPECT_NEAR(cup.bottom.z, 2, 1e-3);
}

TEST(InspectDrainage, TurnedOverTheSameBoxDrainsAsPrinted) {
  const InspectedDrainage found = look_at(hollow_box({BoxHole::top}), {0, 0, -1});
  EXPECT_LT(found.pools.upright, 1);
  expect_volume(found.pools.upside_down, kHollowOfBox, found.spacing);
  EXPECT_TRUE(found.cups.empty());
}

TEST(InspectDrainage, AHoleInTheMiddleOfASideLeavesWhatIsBelowItWhicheverWayUp) {
  const InspectedDrainage found = look_at(hollow_box({BoxHole::side_middle}));
  expect_volume(found.pools.upright, kBelowSideHole, found.spacing);
  expect_volume(found.pools.upside_down, kBelowSideHole, found.spacing);
  expect_volume(found.pools.after_both, kBelowSideHole, found.spacing);
  ASSERT_FALSE(found.cups.empty());
  EXPECT_NEAR(found.cups.front().height, 15, 0.11);
}

TEST(InspectDrainage, AHoleThatIsLevelWithTheFloorLeavesNothing) {
  const InspectedDrainage found = look_at(hollow_box({BoxHole::side_low}));
  EXPECT_LT(found.pools.upright, 1);
  expect_volume(found.pools.upside_down, 30.0 * 30 * 26, found.spacing);
  EXPECT_LT(found.pools.after_both, 1);
  EXPECT_TRUE(found.cups.empty());
}

TEST(InspectDrainage, TiltedByHalfARightAngleTheEdgeBelowTheHoleHoldsAPrism) {
  // Up is +x and +z alike: the lowest edge of the hollow is that at x = z = 2, and the hole at x = 0 and z from 15 to 19
  // begins at its lower side's inner edge, x = 2 and z = 15. Below that height lies half a square of 13 mm.
  const InspectedDrainage found = look_at(hollow_box({BoxHole::side_middle}), normalised(Vec3d{1, 0, 1}));
  const double expected = 13.0 * 13 / 2 * 30;
  EXPECT_NEAR(found.pools.upright, expected, 0.03 * expected);
}

TEST(InspectDrainage, ASealedBoxIsSealedAndNoPool) {
  const InspectedDrainage found = look_at(hollow_box({}));
  ASSERT_EQ(found.found.hollows.size(), 1U);
  EXPECT_TRUE(found.found.hollows.front().is_sealed);
  EXPECT_TRUE(found.found.holes.empty());
  EXPECT_EQ(found.pools.total, 0);
  ASSERT_FALSE(found.cups.empty());  // while its lid is not printed
  expect_volume(found.cups.front().area, 900, found.spacing);
}

TEST(InspectDrainage, ARingHasNoHollow) {
  const InspectedDrainage found = look_at(make_torus(20, 5, 64, 32));
  EXPECT_TRUE(found.found.hollows.empty());
  EXPECT_TRUE(found.found.holes.empty());
  EXPECT_FALSE(found.found.wall.has_value());
}

// Walls of 0.2 mm are thinner than columns are wide: what is on either side does not run together all the same.
TEST(InspectDrainage, AWallThinnerThanAColumnHolds) {
  const Mesh box = make_box({0, 0, 0}, {30, 30, 30});
  const Mesh sealed = join(box, turned_inside_out(make_box({0.2F, 0.2F, 0.2F}, {29.8F, 29.8F, 29.8F})));
  const InspectedDrainage found = look_at(sealed);
  ASSERT_EQ(found.found.hollows.size(), 1U);
  EXPECT_TRUE(found.found.hollows.front().is_sealed);
  ASSERT_TRUE(found.found.wall.has_value());
  EXPECT_NEAR(found.found.wall->thickness, 0.2, 1e-3);
}

TEST(InspectDrainage, AnOpenTubeIsNoHollowAndHoldsNothing) {
  const std::vector<float> across{0, 5, 8, 13};
  const Mesh tube =
      make_blocks({across, across, {0, 30}}, [](int x, int y, int) { return x != 1 || y != 1; });
  const InspectedDrainage found = look_at(tube);
  EXPECT_TRUE(found.found.hollows.empty());
  EXPECT_EQ(found.recesses_upright, 0);
  EXPECT_TRUE(found.cups.empty());
}

TEST(InspectDrainage, ABlindHoleIsARecessNotAHollow) {
  const std::vector<float> across{0, 5, 8, 13};
  const Mesh blind = make_blocks({across, across, {0, 10, 30}},
                                 [](int x, int y, int z) { return x != 1 || y != 1 || z != 1; });
  const InspectedDrainage found = look_at(blind);
  EXPECT_TRUE(found.found.hollows.empty());
  EXPECT_NEAR(found.recesses_upright, 3.0 * 3 * 20, 60);
  EXPECT_EQ(found.recesses_upside_down, 0);
}

}  // namespace
}  // namespace aerate::test
