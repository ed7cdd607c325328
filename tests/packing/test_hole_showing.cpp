#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "core/surface_index.h"
#include "packing/hole_showing.h"
#include "packing/tube_clearance.h"
#include "tests/support/blocks.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

constexpr Vec3d kUp{0, 0, 1};
constexpr double kRadius = 1.5;
constexpr double kNoPlate = -1e300;

// A hole that comes straight out of the surface at a place, along a direction.
Tube hole_at(Vec3d place, Vec3d outwards) {
  return {place - outwards * 5, place, kRadius};
}

// A model, and what is asked of holes in it.
struct Asked {
  explicit Asked(const Mesh& mesh, double plate_height = kNoPlate)
      : surface(mesh), clearance(surface, Packing{}, 20, kRadius), plate(plate_height) {}

  double shows(Vec3d place, Vec3d outwards) const { return showing().of(hole_at(place, outwards)); }
  bool allows(Vec3d place, Vec3d outwards) const { return showing().is_allowed(hole_at(place, outwards)); }

  SurfaceIndex surface;
  TubeClearance clearance;
  double plate;
  DrainageRequest request;

 private:
  HoleShowing showing() const { return {clearance, kUp, plate, request}; }
};

Mesh box_of_40() {
  return test::make_box({0, 0, 0}, {40, 40, 40});
}

// A block with a slot along y, 20 mm wide, open at the top.
Mesh block_with_slot(float floor) {
  const std::array<std::vector<float>, 3> planes{std::vector<float>{0, 20, 40, 60}, {0, 200}, {0, floor, 40}};
  return test::make_blocks(planes, [](int x, int, int z) { return z == 0 || x != 1; });
}

TEST(HoleShowing, WhatNothingKeepsOffShowsByItsSide) {
  const Asked box(box_of_40());
  // Views from the back count nine tenths, which is less than a fifth of them.
  EXPECT_NEAR(box.shows({20, 20, 40}, kUp), 1, 0.05);
  EXPECT_NEAR(box.shows({20, 20, 0}, -kUp), 1.0 / 3, 0.02);
  // Of a wall half of the views are from below.
  EXPECT_NEAR(box.shows({20, 0, 20}, {0, -1, 0}), 2.0 / 3, 0.03);
  EXPECT_NEAR(box.shows({20, 40, 20}, {0, 1, 0}), 0.9 * 2 / 3, 0.05);
}

TEST(HoleShowing, OnAFloorIsWhatTheWallsLeaveOfTheSky) {
  for (const float floor : {20.0F, 30.0F}) {
    const Asked block(block_with_slot(floor));
    // Between walls of depth d, a width of w apart and long: w / sqrt(w^2 + 4 d^2) of a floor's light.
    const double depth = 40 - floor, width = 20;
    const double open = width / std::sqrt(width * width + 4 * depth * depth);
    EXPECT_NEAR(block.shows({30, 100, floor}, kUp), open, 0.07) << floor;
  }
}

TEST(HoleShowing, IsNotLessForWhatIsFarOff) {
  const auto under_roof_at = [](float height) {
    const Mesh roof = test::make_box({-200, -200, height}, {240, 240, height + 5});
    return Asked(test::join(box_of_40(), roof)).shows({20, 20, 40}, kUp);
  };
  EXPECT_LT(under_roof_at(42), 0.1);
  EXPECT_NEAR(under_roof_at(40 + 21 * static_cast<float>(kRadius)), 1, 0.05);
}

TEST(HoleShowing, AllowsTheSidesThatAreAskedFor) {
  Asked box(box_of_40());
  EXPECT_TRUE(box.allows({20, 20, 40}, kUp));
  box.request.sides.on = {{-1, 0, 0}, {0, 0, -1}};
  EXPECT_TRUE(box.allows({0, 20, 20}, {-1, 0, 0}));
  EXPECT_TRUE(box.allows({20, 20, 0}, -kUp));
  EXPECT_FALSE(box.allows({20, 20, 40}, kUp));
  EXPECT_FALSE(box.allows({20, 0, 20}, {0, -1, 0}));
  // A hole's direction is not that of the surface.
  EXPECT_TRUE(box.allows({0, 20, 20}, normalised(Vec3d{-1, 0, 1.5})));

  // Across the edge to a side that is not asked for.
  EXPECT_FALSE(box.allows({0, 39, 20}, {-1, 0, 0}));
  EXPECT_FALSE(box.allows({0, 20, 38.5}, normalised(Vec3d{-1, 0, 0.5})));
  EXPECT_TRUE(box.allows({0, 20, 1}, {-1, 0, 0}));  // this one is

  box.request.sides = {};
  box.request.sides.not_on = {{-1, 0, 0}};
  EXPECT_FALSE(box.allows({0, 20, 20}, {-1, 0, 0}));
  EXPECT_TRUE(box.allows({20, 0, 20}, {0, -1, 0}));

  box.request.sides = {};
  box.request.sides.not_above = 25;
  box.request.sides.not_below = 10;
  EXPECT_TRUE(box.allows({0, 20, 24}, {-1, 0, 0}));
  EXPECT_FALSE(box.allows({0, 20, 26}, {-1, 0, 0}));
  EXPECT_FALSE(box.allows({0, 20, 9}, {-1, 0, 0}));
}

TEST(HoleShowing, AllowsNoHoleThatReachesIntoARegion) {
  Asked box(box_of_40());
  box.request.sides.not_within = {{{-5, 10, 10}, {5, 20, 20}}};
  EXPECT_FALSE(box.allows({0, 15, 15}, {-1, 0, 0}));
  EXPECT_FALSE(box.allows({0, 20 + 0.9 * kRadius, 15}, {-1, 0, 0}));
  EXPECT_TRUE(box.allows({0, 20 + 1.1 * kRadius, 15}, {-1, 0, 0}));
}

TEST(HoleShowing, AvoidsTheBuildPlateWhereThatIsAskedFor) {
  Asked box(box_of_40(), 0);
  EXPECT_TRUE(box.allows({20, 20, 0}, -kUp));
  box.request.avoids_plate = true;
  EXPECT_FALSE(box.allows({20, 20, 0}, -kUp));
  // The rim of a hole in a wall.
  EXPECT_FALSE(box.allows({0, 20, kRadius + 0.2}, {-1, 0, 0}));
  EXPECT_TRUE(box.allows({0, 20, kRadius + 0.4}, {-1, 0, 0}));
  EXPECT_TRUE(box.allows({20, 20, 40}, kUp));
  // A leaning hole whose middle comes out of the wall, and its lower side of the bottom.
  EXPECT_FALSE(box.allows({0, 20, 2}, normalised(Vec3d{-0.8, 0, -0.6})));
  EXPECT_TRUE(box.allows({0, 20, 2}, normalised(Vec3d{-0.8, 0, 0.6})));
}

TEST(HoleShowing, SaysWhatEachHoleIsFor) {
  Asked box(box_of_40());
  box.request.escape_holes = {{20, 20, 40}};
  const HoleShowing showing(box.clearance, kUp, kNoPlate, box.request);
  std::vector<EscapeHole> holes{{.tube = hole_at({20, 20, 40}, kUp)},
                                {.tube = hole_at({20, 20, 0}, -kUp)},
                                {.tube = hole_at({0, 20, 20}, {-1, 0, 0})},
                                {.tube = hole_at({20, 0, 20}, {0, -1, 0}), .network = 1}};
  describe_holes(holes, box.request, showing);
  EXPECT_EQ(holes[0].purpose, HolePurpose::asked);
  EXPECT_EQ(holes[1].purpose, HolePurpose::drain);
  EXPECT_EQ(holes[2].purpose, HolePurpose::pool);   // the third of its network
  EXPECT_EQ(holes[3].purpose, HolePurpose::drain);  // the first of another
  EXPECT_NEAR(holes[1].shows, 1.0 / 3, 0.02);
}

}  // namespace
}  // namespace aerate
