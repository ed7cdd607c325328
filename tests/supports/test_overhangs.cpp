#include <cmath>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/monitor.h"
#include "supports/overhangs.h"
#include "supports/support_rules.h"
#include "tests/support/shapes.h"

namespace aerate::test {
namespace {

Overhangs found(const Mesh& mesh, const char* process = "fdm", Vec3d up = {0, 0, 1}) {
  Monitor monitor;
  return find_overhangs(mesh, *support_rules(*find_process(process)), up, monitor);
}

// Two legs of 20 mm and a beam over them; parts that touch.
Mesh bridge(float span) {
  Mesh mesh = make_box({0, 0, 0}, {5, 10, 20});
  mesh = join(mesh, make_box({5 + span, 0, 0}, {10 + span, 10, 20}));
  return join(mesh, make_box({0, 0, 20}, {10 + span, 10, 25}));
}

// A column with a level arm to one side, 10 mm wide.
Mesh with_arm(float length) {
  return join(make_box({0, 0, 0}, {10, 10, 20}), make_box({10, 0, 15}, {10 + length, 10, 20}));
}

TEST(Overhangs, ABlockHasNone) {
  EXPECT_TRUE(found(make_box({0, 0, 0}, {30, 30, 30})).regions.empty());
}

TEST(Overhangs, ABridgeOfTheProcessNeedsNone) {
  EXPECT_TRUE(found(bridge(4.8F)).regions.empty());
  ASSERT_EQ(found(bridge(8)).regions.size(), 1U);
}

TEST(Overhangs, SaysAreaPlaceAndWidth) {
  const Overhangs overhangs = found(bridge(20));
  ASSERT_EQ(overhangs.regions.size(), 1U);
  const OverhangRegion& region = overhangs.regions.front();
  EXPECT_NEAR(region.area, 20 * 10, 15);
  EXPECT_NEAR(region.width, 10, 1);
  ASSERT_TRUE(region.farthest);
  EXPECT_NEAR(*region.farthest, 10, 0.6);
  EXPECT_NEAR(region.place.x, 15, 0.6);
  EXPECT_NEAR(region.place.z, 20, 1e-5);
  EXPECT_NEAR(region.height, 20, 1e-5);
}

TEST(Overhangs, AnArmIsHeldOnOneSideOnly) {
  EXPECT_TRUE(found(with_arm(2)).regions.empty());
  const Overhangs overhangs = found(with_arm(4));  // narrower than the bridge, and held by one end
  ASSERT_EQ(overhangs.regions.size(), 1U);
  EXPECT_NEAR(*overhangs.regions.front().farthest, 4, 0.6);
}

TEST(Overhangs, FollowTheDirectionOfPrint) {
  EXPECT_EQ(found(with_arm(20)).regions.size(), 1U);
  EXPECT_TRUE(found(with_arm(20), "fdm", {0, 1, 0}).regions.empty());
  const Overhangs upside_down = found(with_arm(20), "fdm", {0, 0, -1});
  EXPECT_TRUE(upside_down.regions.empty());
  const Overhangs on_its_end = found(with_arm(20), "fdm", {-1, 0, 0});
  ASSERT_EQ(on_its_end.regions.size(), 1U);
  EXPECT_NEAR(on_its_end.regions.front().place.x, 10, 1e-4);
}

TEST(Overhangs, ABallBeginsInTheAirIfItHangs) {
  Mesh mesh = join(make_box({-20, -20, 0}, {-15, 20, 40}), make_box({-15, -2, 30}, {2, 2, 34}));
  mesh = join(mesh, moved(make_uv_sphere(8, 48, 96), {0, 0, 28}));
  const Overhangs overhangs = found(mesh);
  ASSERT_GE(overhangs.regions.size(), 1U);
  bool begins = false;
  for (const OverhangRegion& region : overhangs.regions) {
    if (region.farthest) continue;
    begins = true;
    EXPECT_NEAR(region.place.z, 20, 0.1);
    EXPECT_NEAR(std::hypot(region.place.x, region.place.y), 0, 0.7);
    // Within the circle where the ball leans out by 50 degrees.
    EXPECT_NEAR(region.area, 3.1416 * std::pow(8 * std::sin(0.698), 2), 12);
  }
  EXPECT_TRUE(begins);
}

TEST(Overhangs, ASteepTipThatBeginsInTheAirIsFound) {
  // A spike that hangs from an arm: 30 degrees from the vertical.
  Mesh spike;
  spike.positions = {{20, 5, 5}, {15, 0, 15}, {25, 0, 15}, {25, 10, 15}, {15, 10, 15}};
  spike.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 1, 4}, {1, 2, 3}, {1, 3, 4}};
  const Mesh mesh = join(with_arm(15), spike);
  std::size_t in_air = 0;
  for (const OverhangRegion& region : found(mesh).regions) {
    if (region.farthest) continue;
    ++in_air;
    EXPECT_NEAR(region.place.z, 5, 0.6);
  }
  EXPECT_EQ(in_air, 1U);
}

TEST(Overhangs, AFloorBelowHoldsNothing) {
  // A slot of 0.5 mm, less than a column is wide.
  Mesh mesh = join(make_box({0, 0, 0}, {30, 20, 10}), make_box({0, 0, 10}, {8, 20, 10.5F}));
  mesh = join(mesh, make_box({0, 0, 10.5F}, {30, 20, 16}));
  const Overhangs overhangs = found(mesh);
  ASSERT_EQ(overhangs.regions.size(), 1U);
  EXPECT_NEAR(*overhangs.regions.front().farthest, 22, 0.6);
}

TEST(Overhangs, CeilingsOfSealedCavitiesStayOut) {
  Mesh cavity = make_box({5, 5, 5}, {25, 25, 25});
  for (Triangle& t : cavity.triangles) std::swap(t[1], t[2]);
  EXPECT_TRUE(found(join(make_box({0, 0, 0}, {30, 30, 30}), cavity)).regions.empty());
}

TEST(Overhangs, LimitsAreTheProcesss) {
  EXPECT_EQ(found(with_arm(2), "sla").regions.size(), 1U);    // 1 mm
  EXPECT_EQ(found(with_arm(2), "metal").regions.size(), 1U);  // a bridge of 2 mm
  EXPECT_FALSE(support_rules(*find_process("sls")));
  EXPECT_THROW(static_cast<void>(require_support_rules(*find_process("sls"))), UsageError);
  EXPECT_DOUBLE_EQ(support_rules(*find_process("sla"))->reach, 1);
  EXPECT_DOUBLE_EQ(support_rules(*find_process("fdm"))->reach, 2.5);
}

}  // namespace
}  // namespace aerate::test
