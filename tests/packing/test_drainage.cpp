#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "core/disjoint_sets.h"
#include "core/error.h"
#include "core/overhang.h"
#include "core/segment_distance.h"
#include "core/void_shape.h"
#include "packing/adaptive.h"
#include "packing/hole_places.h"
#include "packing/placed_tubes.h"
#include "packing/plan_drainage.h"
#include "packing/pools.h"
#include "packing/tube_clearance.h"
#include "packing/tube_through.h"
#include "tests/support/caught.h"
#include "tests/support/clearance.h"
#include "tests/support/place_said.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

using test::contains;
using test::message_of;

constexpr Vec3d kUp{0, 0, 1};

Sphere ball(Vec3d centre, double radius) {
  return {centre, radius, SphereKind::adaptive};
}

VoidShape shape(Vec3d centre, double radius, const Roof& roof = {}) {
  return {ball(centre, radius), roof};
}

// With walls of 2 mm, and gaps of 1 mm.
Packing packing_of(std::vector<Sphere> spheres) {
  Packing packing;
  packing.spheres = std::move(spheres);
  packing.limits = {.wall = 2, .gap = 1};
  return packing;
}

TEST(Tubes, RingsLieOnTheBallAndOnTheTube) {
  const VoidShape sphere = shape({1, 2, 3}, 5);
  const Tube tube{{2, 2, 3.5}, {9, 5, 6}, 1.5};
  ASSERT_TRUE(sphere.crossing(tube, TubeEnd::start));
  const TubeFrame frame = frame_of(tube, kUp);
  EXPECT_NEAR(dot(cross(frame.axis, frame.down), frame.across), 1, 1e-12);
  for (const TubeEnd end : {TubeEnd::start, TubeEnd::end}) {
    const std::vector<Vec3d> ring = sphere.rim(tube, end, 24);
    for (const Vec3d p : ring) {
      EXPECT_NEAR(length(p - sphere.centre()), 5, 1e-9);
      const Vec3d from_start = p - tube.start;
      EXPECT_NEAR(length(from_start - frame.axis * dot(from_start, frame.axis)), 1.5, 1e-9);
      EXPECT_EQ(dot(p - sphere.centre(), frame.axis) > 0, end == TubeEnd::start);
    }
  }
  EXPECT_FALSE(sphere.crossing({{1, 5, 3}, {9, 5, 3}, 2.5}, TubeEnd::start));  // its side runs past the ball
}

TEST(Tubes, HaveEnoughSidesForTheTolerance) {
  for (const double tolerance : {0.5, 0.05, 0.005}) {
    const auto sides = static_cast<double>(tube_sides(2, tolerance));
    EXPECT_LE(2 * (1 - std::cos(std::numbers::pi / sides)), tolerance);
    EXPECT_GE(sides, 8);
  }
}

TEST(Tubes, BetweenBallsHoldAllThatIsOutsideThem) {
  const VoidShape a = shape({0, 0, 0}, 4), b = shape({12, 0, 3}, 5);
  const auto tube = tube_between(a, b, a.centre(), b.centre(), 1.5);
  ASSERT_TRUE(tube.has_value());
  for (const Vec3d p : a.rim(*tube, TubeEnd::start, 48))
    EXPECT_GE(dot(p - tube->start, tube->end - tube->start), -1e-9);
  for (const Vec3d p : b.rim(*tube, TubeEnd::end, 48))
    EXPECT_LE(dot(p - tube->end, tube->end - tube->start), 1e-9);
  EXPECT_FALSE(tube_between(a, b, a.centre(), b.centre(), 3.9).has_value());
}

TEST(Pools, VolumeBelowAHeight) {
  const VoidShape sphere = shape({7, 8, 9}, 3);
  const double whole = 36 * std::numbers::pi;
  EXPECT_EQ(sphere.volume_below(kUp, 6), 0);
  EXPECT_NEAR(sphere.volume_below(kUp, 9), whole / 2, 1e-9);
  EXPECT_NEAR(sphere.volume_below(kUp, 12), whole, 1e-9);
  EXPECT_NEAR(sphere.volume_below(kUp, 7), std::numbers::pi * (9 - 1) / 3, 1e-9);  // cap of height 1
  EXPECT_NEAR(sphere.volume_below(-kUp, -10), sphere.volume_below(kUp, 8), 1e-9);
}

TEST(Pools, VolumeOfAVoidWithARoofBelowAHeight) {
  const Roof roof = make_roof({.degrees = 45, .bridge = 2, .up = kUp});
  const VoidShape sphere = shape({7, 8, 9}, 3, roof);
  const double whole = sphere.volume(), top = 9 + roof.top(3);
  EXPECT_EQ(sphere.volume_below(kUp, 6), 0);
  EXPECT_NEAR(sphere.volume_below(kUp, 9), 18 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(sphere.volume_below(kUp, top), whole, 1e-9);
  EXPECT_NEAR(sphere.volume_below(kUp, 50), whole, 1e-9);
  // The frustum below the flat top, a millimetre in radius.
  EXPECT_NEAR(whole - sphere.volume_below(kUp, top - 0.5), std::numbers::pi / 3 * (3.375 - 1), 1e-9);
  EXPECT_NEAR(sphere.volume_below(-kUp, -top), 0, 1e-9);
  EXPECT_NEAR(sphere.volume_below(-kUp, -10), whole - sphere.volume_below(kUp, 10), 1e-9);
}

TEST(Tubes, OpenBelowRoofsAndLeanNoFurtherThanIsBridged) {
  const Roof roof = make_roof({.degrees = 45, .bridge = 2, .up = kUp});
  const VoidShape sphere = shape({0, 0, 0}, 5, roof);
  const auto at = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return Tube{{0, 0, 0}, Vec3d{std::cos(angle), 0, std::sin(angle)} * 9, 1};
  };
  // Half as wide as asin(1/5) is 11.5 degrees, and 0.4 mm are 4.6.
  EXPECT_TRUE(sphere.opens_below_roof(at(28), TubeEnd::start));
  EXPECT_FALSE(sphere.opens_below_roof(at(30), TubeEnd::start));
  EXPECT_FALSE(sphere.opens_below_roof(at(90), TubeEnd::start));
  EXPECT_TRUE(sphere.opens_below_roof(at(30), TubeEnd::end));  // at the far side, below the centre
  EXPECT_TRUE(shape({0, 0, 0}, 5).opens_below_roof(at(90), TubeEnd::start));
  EXPECT_EQ(ceiling_width(at(45.1), roof), 0);
  EXPECT_NEAR(ceiling_width(at(0), roof), std::sqrt(2.0), 1e-9);
  EXPECT_TRUE(is_bridged(at(0), roof));
  EXPECT_FALSE(is_bridged({{0, 0, 0}, {1, 0, 0}, 1.5}, roof));
  EXPECT_TRUE(is_bridged({{0, 0, 0}, {1, 0, 1}, 1.5}, roof));
  EXPECT_TRUE(is_bridged({{0, 0, 0}, {1, 0, 0}, 1.5}, {}));
}

// A ball with a hole to the side and a lower ball behind it: what lies below the hole stays in the first, and
// all of the second.
TEST(Pools, OfTwoBallsAndALevelHole) {
  const std::vector<VoidShape> voids{shape({0, 0, 10}, 4), shape({0, 0, 0}, 4)};
  DrainagePlan plan;
  plan.channels.push_back({1, 0, *tube_between(voids[1], voids[0], {0, 0, 0}, {0, 0, 10}, 1)});
  plan.holes.push_back({0, *tube_out_of(voids[0], {0, 0, 10}, {1, 0, 0}, 6, 1), 0});
  const SpillHeights spills = spill_heights(voids, plan, kUp);
  EXPECT_NEAR(spills.height[0], 9, 1e-9);  // the hole's lower side
  EXPECT_NEAR(spills.height[1], 9, 1e-9);
  EXPECT_EQ(spills.towards[1], 0U);
  EXPECT_EQ(spills.towards[0], kNone);

  const TrappedPools pools = trapped_pools(voids, plan);
  const double tube = std::numbers::pi * length(plan.channels[0].tube.end - plan.channels[0].tube.start);
  const double whole = 4.0 / 3.0 * std::numbers::pi * 64;
  EXPECT_NEAR(pools.upright, voids[0].volume_below(kUp, 9) + whole + tube, 0.05);
  // Upside down the lower ball is above the hole and its channel opens at its lowest point; in the other
  // stays what is below the hole's other side.
  EXPECT_NEAR(pools.upside_down, voids[0].volume_below(-kUp, -11), 1e-6);
  EXPECT_LE(pools.after_both, pools.upside_down + 1e-9);
  EXPECT_NEAR(pools.total, 2 * whole + tube, 1e-9);
}

TEST(Pools, NothingStaysAboveAHoleAtTheLowestPoint) {
  const std::vector<VoidShape> voids{shape({0, 0, 0}, 4), shape({0, 0, 10}, 4)};
  DrainagePlan plan;
  plan.channels.push_back({0, 1, *tube_between(voids[0], voids[1], {0, 0, 0}, {0, 0, 10}, 1)});
  plan.holes.push_back({0, *tube_out_of(voids[0], {0, 0, 0}, {0, 0, -1}, 3, 1), 0});
  EXPECT_NEAR(trapped_pools(voids, plan).upright, 0, 1e-9);
}

TEST(Pools, ABallThatNothingLeadsOutOfStaysFull) {
  const std::vector<VoidShape> voids{shape({0, 0, 0}, 4), shape({0, 0, 20}, 4)};
  DrainagePlan plan;
  plan.holes.push_back({0, *tube_out_of(voids[0], {0, 0, 0}, {0, 0, -1}, 3, 1), 0});
  EXPECT_NEAR(trapped_pools(voids, plan).after_both, 4.0 / 3.0 * std::numbers::pi * 64, 1e-6);
}

TEST(TubeClearances, ATubeThatComesOutTooObliquelyIsRefused) {
  const Mesh box = test::make_box({0, 0, 0}, {40, 40, 40});
  const Packing packing = packing_of({ball({20, 20, 20}, 5)});
  const SurfaceIndex surface(box);
  const TubeClearance clearance(surface, packing, 20, 2);
  const auto towards = [&](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3d direction{std::cos(angle), 0, -std::sin(angle)};
    const Vec3d start{20, 20, 12};
    return Tube{start, start + direction * (12 / std::sin(angle)), 1};
  };
  EXPECT_TRUE(clearance.keeps_wall_on_way_out(towards(90), 0.5));
  EXPECT_TRUE(clearance.keeps_wall_on_way_out(towards(50), 0.5));
  EXPECT_FALSE(clearance.keeps_wall_on_way_out(towards(29), 0.5));
  EXPECT_FALSE(clearance.keeps_wall(towards(90)));  // a channel may not come out at all
  // A place between samples: a thin slot that comes within half the wall of the tube.
  const Mesh slotted =
      test::join(box, test::turned_inside_out(test::make_box({22, 19.99F, 6}, {30, 20.01F, 6.02F})));
  const SurfaceIndex slotted_surface(slotted);
  const TubeClearance beside(slotted_surface, packing, 20, 2);
  EXPECT_FALSE(beside.keeps_wall_on_way_out(towards(90), 0.5));
}

TEST(TubeClearances, WhereARayMeetsTheSurface) {
  const Mesh box = test::make_box({0, 0, 0}, {40, 40, 40});
  const SurfaceIndex surface(box);
  const TubeClearance clearance(surface, packing_of({ball({20, 20, 20}, 5)}), 20, 2);
  EXPECT_NEAR(clearance.first_hit({20, 21, 12}, {0, 0, -1}, 50).value(), 12, 1e-12);
  EXPECT_NEAR(clearance.first_hit({20, 21, 12}, {0.6, 0, 0.8}, 50).value(), 20 / 0.6, 1e-9);
  EXPECT_FALSE(clearance.first_hit({20, 21, 12}, {0, 0, -1}, 11).has_value());
  EXPECT_FALSE(clearance.first_hit({20, 21, 50}, {0, 0, 1}, 100).has_value());
}

TEST(PlacedTubes, KeepClearOfThoseThatAreThereAndNoOthers) {
  const Tube tube{{0, 0, 0}, {10, 0, 0}, 1}, beside{{0, 2.9, 0}, {10, 2.9, 0}, 1};
  PlacedTubes tubes({}, 1, 20, 2);
  EXPECT_TRUE(tubes.keep_clear_of(beside, 2, 3));
  tubes.place(Channel{0, 1, tube});
  tubes.place(EscapeHole{4, {{0, 0, 9}, {10, 0, 9}, 1}, 0});
  EXPECT_FALSE(tubes.keep_clear_of(beside, 2, 3));  // 0.9 mm from the channel
  EXPECT_TRUE(tubes.keep_clear_of(beside, 1, 3));   // as far as openings into one void have to be
  EXPECT_FALSE(tubes.keep_clear_of({{0, 2.9, 9}, {10, 2.9, 9}, 1}, 2, 2));
  PlacedTubes fewer = tubes;
  fewer.remove_tubes_of([](std::uint32_t i) { return i == 1; });
  EXPECT_TRUE(fewer.keep_clear_of(beside, 2, 3));
  EXPECT_FALSE(fewer.keep_clear_of({{0, 2.9, 9}, {10, 2.9, 9}, 1}, 2, 2));
  EXPECT_EQ(fewer.plan().channels.size(), 0U);
  EXPECT_EQ(fewer.plan().holes.size(), 1U);
  EXPECT_FALSE(tubes.keep_clear_of(beside, 2, 3));  // the copy was changed, not this
  EXPECT_EQ(tubes.plan().channels.size(), 1U);
}

TEST(HolePlaces, ComeInOrderBeforeAllAreLookedAt) {
  const Mesh box = test::make_box({0, 0, 0}, {60, 40, 40});
  const Packing packing = packing_of({ball({12, 20, 10}, 7), ball({30, 20, 14}, 8), ball({48, 18, 26}, 9)});
  const std::vector<VoidShape> voids = shapes_of(packing.spheres, {});
  const DrainageRequest request{.channel_radius = 1, .hole_radius = 2, .escape_holes = {}};
  const SurfaceIndex surface(box);
  const TubeClearance clearance(surface, packing, 20, 2);
  HolePlaces places({surface, surface.winding()}, voids, packing.limits, request, clearance);
  const auto all = [&] {
    std::vector<EscapeHole> holes;
    HolePlaces::Ranking ranking = places.ranked(std::vector<std::uint32_t>{0, 1, 2}, {0, 0, -1}, 1);
    while (const auto hole = ranking.next()) holes.push_back(*hole);
    return holes;
  };
  const std::vector<EscapeHole> found = all();
  const std::vector<EscapeHole> known = all();  // now every cost is known
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(found.front().tube.end.z, 0, 1e-9);
  ASSERT_EQ(found.size(), known.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].from, known[i].from);
    EXPECT_EQ(length_squared(found[i].tube.start - known[i].tube.start), 0);
    EXPECT_EQ(length_squared(found[i].tube.end - known[i].tube.end), 0);
  }
}

class PlanDrainage : public testing::Test {
 protected:
  void pack(const Mesh& mesh, const Roof& roof = {}) {
    mesh_ = mesh;
    Monitor silent;
    packing_ = pack_adaptive(mesh_, {.wall = 2, .gap = 1, .min_radius = 2.5, .max_radius = 8, .roof = roof},
                             {}, silent);
  }
  PlannedDrainage plan(const std::vector<Triangle>& outward) const {
    Monitor silent;
    const SurfaceIndex surface(mesh_);
    const kernels::HostWinding winding(mesh_.positions, outward);
    return plan_drainage(
        {surface, winding.view()}, packing_, request_, [](const EscapeHole&) { return true; }, silent);
  }
  PlannedDrainage plan() const { return plan(mesh_.triangles); }

  std::vector<VoidShape> kept(const PlannedDrainage& planned) const {
    std::vector<VoidShape> voids;
    for (const std::uint32_t i : planned.kept) voids.emplace_back(packing_.spheres[i], packing_.limits.roof);
    return voids;
  }

  // By brute force: every tube keeps wall and gap, and from each void channels lead to a hole.
  void expect_sound(const PlannedDrainage& planned) const {
    const std::vector<VoidShape> voids = kept(planned);
    std::vector<std::uint32_t> reached;
    for (const EscapeHole& hole : planned.plan.holes) {
      EXPECT_TRUE(voids[hole.from].crossing(hole.tube, TubeEnd::start));
      EXPECT_TRUE(voids[hole.from].opens_below_roof(hole.tube, TubeEnd::start));
      EXPECT_TRUE(is_bridged(hole.tube, packing_.limits.roof));
      EXPECT_NEAR(test::distance_to_surface(mesh_, hole.tube.end), 0, 1e-3);
      reached.push_back(hole.from);
    }
    for (const Channel& c : planned.plan.channels) {
      EXPECT_TRUE(voids[c.from].crossing(c.tube, TubeEnd::start));
      EXPECT_TRUE(voids[c.to].crossing(c.tube, TubeEnd::end));
      EXPECT_TRUE(voids[c.from].may_open(c.tube, TubeEnd::start));
      EXPECT_TRUE(voids[c.to].may_open(c.tube, TubeEnd::end));
      EXPECT_TRUE(is_bridged(c.tube, packing_.limits.roof));
      const Segment axis{c.tube.start, c.tube.end};
      for (const Triangle& t : mesh_.triangles)
        EXPECT_GE(distance_to_facet(axis, facet_of(mesh_, t)), c.tube.radius + 2 - 1e-9);
      for (std::uint32_t i = 0; i < voids.size(); ++i) {
        if (i != c.from && i != c.to) {
          EXPECT_GE(voids[i].distance_to(axis), c.tube.radius + 1 - 1e-7);
        }
      }
    }
    std::set<std::uint32_t> known(reached.begin(), reached.end());
    while (!reached.empty()) {
      const std::uint32_t at = reached.back();
      reached.pop_back();
      for (const Channel& c : planned.plan.channels) {
        const bool leads = c.from == at || c.to == at;
        const std::uint32_t other = c.from == at ? c.to : c.from;
        if (leads && known.insert(other).second) reached.push_back(other);
      }
    }
    EXPECT_EQ(known.size(), voids.size());
    EXPECT_EQ(planned.kept.size() + planned.dropped.count(), packing_.spheres.size());
    // Where two holes were asked for, no more are made for what they leave.
    if (request_.escape_holes.size() < 2) {
      EXPECT_LE(planned.plan.pools.after_both, 0.01 * planned.plan.pools.total + 1e-9);
    }
  }

  Mesh mesh_;
  Packing packing_;
  DrainageRequest request_{.channel_radius = 1.75, .hole_radius = 1.75, .escape_holes = {}};
};

TEST_F(PlanDrainage, JoinsTheVoidsOfABlockAndOpensItLowAndHigh) {
  pack(test::make_box({0, 0, 0}, {50, 40, 40}));
  const PlannedDrainage planned = plan();
  expect_sound(planned);
  EXPECT_GE(planned.kept.size(), packing_.spheres.size() * 8 / 10);
  EXPECT_EQ(planned.plan.channels.size(), planned.kept.size() - planned.plan.network_count);
  const auto [low, high] = std::minmax_element(
      planned.plan.holes.begin(), planned.plan.holes.end(),
      [](const EscapeHole& a, const EscapeHole& b) { return a.tube.end.z < b.tube.end.z; });
  ASSERT_GE(planned.plan.holes.size(), 2U);
  EXPECT_LT(low->tube.end.z, 10);
  EXPECT_GT(high->tube.end.z, 25);
}

TEST_F(PlanDrainage, FollowsThePrintOrientation) {
  pack(test::make_box({0, 0, 0}, {50, 40, 40}));
  packing_.limits.roof.up = {-1, 0, 0};
  const PlannedDrainage planned = plan();
  expect_sound(planned);
  double low = 0, high = 50;
  for (const EscapeHole& hole : planned.plan.holes) {
    low = std::max(low, hole.tube.end.x);
    high = std::min(high, hole.tube.end.x);
  }
  EXPECT_GT(low, 40);
  EXPECT_LT(high, 20);
}

TEST_F(PlanDrainage, KeepsClearOfRoofs) {
  request_.channel_radius = 1.4;
  for (const Vec3d up : {kUp, Vec3d{0, 0.6, -0.8}}) {
    pack(test::make_box({0, 0, 0}, {50, 40, 40}), make_roof({.degrees = 45, .bridge = 2, .up = up}));
    const PlannedDrainage planned = plan();
    expect_sound(planned);
    EXPECT_GE(planned.kept.size(), packing_.spheres.size() * 7 / 10);
  }
}

TEST_F(PlanDrainage, OpensWhereItIsAsked) {
  pack(test::make_box({0, 0, 0}, {50, 40, 40}));
  request_.escape_holes = {{12, 20, 0}, {38, 20, 40.5}};
  const PlannedDrainage planned = plan();
  expect_sound(planned);
  ASSERT_EQ(planned.plan.holes.size(), 2U);
  EXPECT_LT(length(planned.plan.holes[0].tube.end - Vec3d{12, 20, 0}), 1.75);
  EXPECT_LT(length(planned.plan.holes[1].tube.end - Vec3d{38, 20, 40}), 1.75);
}

// The void right above the place is so small that its hole would leave no room for a channel.
TEST_F(PlanDrainage, AHoleThatIsAskedForLeadsToAVoidThatOthersCanJoin) {
  pack(test::make_box({0, 0, 0}, {40, 40, 40}));
  request_.escape_holes = {{20, 20, 0}};
  const PlannedDrainage planned = plan();
  expect_sound(planned);
  EXPECT_LT(length(planned.plan.holes[0].tube.end - Vec3d{20, 20, 0}), 1.75);
  EXPECT_GE(planned.kept.size(), packing_.spheres.size() * 7 / 10);
}

TEST_F(PlanDrainage, OnePlaceThatIsAskedForLeavesOtherPartsToTheirOwn) {
  pack(test::join(test::make_box({0, 0, 0}, {30, 30, 30}), test::make_box({50, 0, 0}, {80, 30, 30})));
  request_.escape_holes = {{65, 15, 0}};
  const PlannedDrainage planned = plan();
  expect_sound(planned);
  EXPECT_EQ(planned.plan.network_count, 2U);
  // Two places are all the holes that the user wants.
  request_.escape_holes = {{65, 15, 0}, {65, 15, 30}};
  EXPECT_EQ(plan().plan.network_count, 1U);
}

// In a flat plate level channels keep liquid in both orientations: few voids can be kept, those with holes of
// their own.
TEST_F(PlanDrainage, LittleStaysInAPlateAndEachGroupHasTwoHoles) {
  pack(test::make_box({0, 0, 0}, {150, 100, 14}));
  const PlannedDrainage planned = plan();
  expect_sound(planned);
  EXPECT_LE(planned.plan.pools.after_both, 0.01 * planned.plan.pools.total);
  DisjointSets sets(planned.kept.size());
  for (const Channel& c : planned.plan.channels) sets.join(c.from, c.to);
  std::map<std::size_t, std::set<std::uint32_t>> networks;
  std::map<std::size_t, int> holes;
  for (const EscapeHole& hole : planned.plan.holes) {
    networks[sets.root(hole.from)].insert(hole.network);
    ++holes[sets.root(hole.from)];
  }
  EXPECT_EQ(networks.size(), planned.plan.network_count);
  for (const auto& [root, numbers] : networks) {
    EXPECT_EQ(numbers.size(), 1U);
    EXPECT_GE(holes[root], 2);
  }
  for (std::uint32_t i = 0; i < planned.kept.size(); ++i) EXPECT_TRUE(networks.contains(sets.root(i)));
}

// Where channels out of dropped branches were still to be kept clear of, 40 voids would be left.
TEST_F(PlanDrainage, WhatWasLeftOutDoesNotStandInTheWay) {
  mesh_ = test::make_box({0, 0, 0}, {110, 100, 22});
  Monitor silent;
  const Roof roof = make_roof({.degrees = 45, .bridge = 2, .up = kUp});
  const PackingLimits limits{.wall = 1, .gap = 1, .min_radius = 3, .max_radius = 8, .roof = roof};
  packing_ = pack_adaptive(mesh_, limits, {}, silent);
  request_ = {.channel_radius = 1.4, .hole_radius = 2.5, .escape_holes = {}};
  EXPECT_GE(plan().kept.size(), 55U);
}

TEST_F(PlanDrainage, DoesNotOpenIntoACavityOfTheModel) {
  // The space below the voids of the upper half is a cavity, which is nearer than the outside.
  const Mesh outside = test::make_box({0, 0, 0}, {40, 40, 60});
  pack(test::join(outside, test::turned_inside_out(test::make_box({3, 3, 3}, {37, 37, 30}))));
  const PlannedDrainage planned = plan(outside.triangles);
  expect_sound(planned);
  for (const EscapeHole& hole : planned.plan.holes)
    EXPECT_LT(test::distance_to_surface(outside, hole.tube.end), 1e-3);
}

TEST_F(PlanDrainage, VoidsTooNarrowAreCounted) {
  pack(test::make_box({0, 0, 0}, {50, 40, 40}));
  packing_.spheres.push_back(ball({1.2, 1.2, 1.2}, 0.5));
  const PlannedDrainage planned = plan();
  EXPECT_EQ(planned.dropped.narrow, 1U);
  EXPECT_GE(planned.dropped.volume, 4.0 / 3.0 * std::numbers::pi * 0.125);
}

TEST_F(PlanDrainage, WhatCannotBeIsRefusedWithWhatToDo) {
  pack(test::make_box({0, 0, 0}, {50, 40, 40}));
  const auto refused = [&] { return message_of<UsageError>([&] { plan(); }); };
  request_.escape_holes = {{12, 20, -30}};
  EXPECT_TRUE(contains(refused(), "outside the model"));
  EXPECT_TRUE(contains(refused(), "(12.00, 20.00, 0.00) mm"));
  request_.escape_holes = {{12, 20, 12}};
  EXPECT_TRUE(contains(refused(), "inside the model, away from its surface"));
  request_.escape_holes = {{12, 20, 0}};
  request_.hole_radius = 7.9;  // as wide as the voids
  EXPECT_TRUE(contains(refused(), "no straight hole leads from"));
  request_.escape_holes = {};
  request_.channel_radius = 9;
  request_.hole_radius = 9;
  EXPECT_TRUE(contains(refused(), "too wide for every void"));
}

// The end of a bar is too far from any void for a hole. The place that the refusal names is one that is taken.
TEST_F(PlanDrainage, WhereNoHoleOpensTheNearestPlaceIsSaid) {
  mesh_ = test::make_box({0, 0, 0}, {120, 30, 30});
  packing_ = packing_of({ball({15, 15, 15}, 8), ball({36, 15, 15}, 9)});
  const Vec3d asked{60, 15, 30};
  request_.escape_holes = {asked};
  const auto place = test::place_said_in(message_of<UsageError>([&] { plan(); }));
  ASSERT_TRUE(place.has_value());
  EXPECT_LT(length(*place - asked), 20);
  request_.escape_holes = {*place};
  EXPECT_LT(length(plan().plan.holes.at(0).tube.end - *place), request_.hole_radius);
  request_.escape_holes = {{110, 15, 30}};
  EXPECT_FALSE(test::place_said_in(message_of<UsageError>([&] { plan(); })).has_value());
}

TEST_F(PlanDrainage, WhereNoHoleCanBeCutNothingIsMade) {
  pack(test::make_box({0, 0, 0}, {50, 40, 40}));
  Monitor silent;
  const SurfaceIndex surface(mesh_);
  EXPECT_THROW(
      plan_drainage(
          {surface, surface.winding()}, packing_, request_, [](const EscapeHole&) { return false; }, silent),
      NothingToRemoveError);
}

TEST_F(PlanDrainage, IsTheSameEveryTime) {
  pack(test::make_box({0, 0, 0}, {50, 40, 40}));
  const PlannedDrainage a = plan(), b = plan();
  EXPECT_EQ(a.kept, b.kept);
  ASSERT_EQ(a.plan.channels.size(), b.plan.channels.size());
  for (std::size_t i = 0; i < a.plan.channels.size(); ++i)
    EXPECT_EQ(a.plan.channels[i].tube.start, b.plan.channels[i].tube.start);
}

}  // namespace
}  // namespace aerate
