#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/overhang.h"
#include "packing/cells/cell_drainage.h"
#include "packing/cells/cell_windows.h"
#include "tests/packing/cell_boxes.h"
#include "tests/support/caught.h"
#include "tests/support/place_said.h"

namespace aerate::test {
namespace {

TEST(CellDrainage, OfTwoBoxesLeavesWhatIsBelowTheSill) {
  const std::vector<Box> boxes = equal_boxes(2, 19.5);
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const PlannedCellDrainage planned = plan(model, cells);
  expect_sound(model, cells, planned, boxes);
  ASSERT_EQ(planned.plan.holes.size(), 2U);
  EXPECT_NEAR(planned.plan.holes[0].tube.end.z, 0, 1e-6);  // straight down
  // Backwards rather than straight up, where it would show.
  EXPECT_NEAR(planned.plan.holes[1].tube.end.y, 24, 1e-6);
  EXPECT_GT(planned.plan.holes[1].tube.end.z, 20);
  const double layer = 19.5 * 20 * 0.011;  // as exact as the window's place
  const double window = std::numbers::pi * 1.5 * 1.5 * kGap;
  EXPECT_NEAR(planned.plan.pools.upright, 19.5 * 20 * kWindowMargin, layer);
  EXPECT_NEAR(planned.plan.pools.total,
              2 * 19.5 * 20 * 20 + window * static_cast<double>(planned.plan.channels.size()), 1e-3);
  EXPECT_LE(planned.plan.pools.after_both, kPoolsAimedAt * planned.plan.pools.total);
  EXPECT_LE(planned.plan.pools.after_both, planned.plan.pools.upright);
}

// What is looked up for one plan enters no other.
TEST(CellDrainage, PlansOfOnePlannerAreThoseOfTheirOwn) {
  const std::vector<Box> boxes = equal_boxes(4, 19.5);
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const SurfaceIndex surface(model);
  const DrainableModel drainable{surface, surface.winding(), nullptr, 0};
  Monitor monitor;
  DrainageRequest anywhere = request_of(), off_plate = anywhere, hidden = anywhere;
  off_plate.avoids_plate = hidden.avoids_plate = true;
  hidden.worth_of_hiding = 0.9;
  const CanOpenCell not_first = [](const Tube&, std::uint32_t from) { return from != 0; };
  const CanOpenWall always = [](const Tube&) { return true; };
  const CanOpenWall only_high = [](const Tube& window) { return window.start.z > 12; };
  CellDrainagePlanner planner(drainable, cells, limits_of(), anywhere, monitor);
  const auto expect_own = [&](const DrainageRequest& request, const CanOpenCell& can_open,
                              const CanOpenWall& can_open_wall) {
    const PlannedCellDrainage shared = planner.plan(request, can_open, can_open_wall);
    const PlannedCellDrainage own =
        plan_cell_drainage(drainable, cells, limits_of(), request, can_open, can_open_wall, monitor);
    EXPECT_EQ(shared.kept, own.kept);
    ASSERT_EQ(shared.plan.holes.size(), own.plan.holes.size());
    for (std::size_t i = 0; i < own.plan.holes.size(); ++i) {
      EXPECT_EQ(shared.plan.holes[i].tube.start, own.plan.holes[i].tube.start);
      EXPECT_EQ(shared.plan.holes[i].tube.end, own.plan.holes[i].tube.end);
      EXPECT_EQ(shared.plan.holes[i].shows, own.plan.holes[i].shows);
    }
    ASSERT_EQ(shared.plan.channels.size(), own.plan.channels.size());
    for (std::size_t i = 0; i < own.plan.channels.size(); ++i)
      EXPECT_EQ(shared.plan.channels[i].tube.start, own.plan.channels[i].tube.start);
    EXPECT_EQ(shared.plan.pools.after_both, own.plan.pools.after_both);
  };
  expect_own(off_plate, kAlways, always);
  expect_own(anywhere, kAlways, always);
  expect_own(hidden, not_first, only_high);
  expect_own(off_plate, kAlways, always);
  // They differ.
  EXPECT_NE(planner.plan(anywhere, kAlways, always).plan.holes[0].tube.end,
            planner.plan(off_plate, kAlways, always).plan.holes[0].tube.end);
  EXPECT_NE(planner.plan(anywhere, kAlways, always).plan.channels[0].tube.start,
            planner.plan(anywhere, kAlways, only_high).plan.channels[0].tube.start);
}

// The second void has a foot below the wall that the two share; what stays in it runs out upside down through
// a window high up.
TEST(CellDrainage, WindowsBesideTheTreeLetOutUpsideDownWhatStaysUpright) {
  std::vector<Box> boxes = equal_boxes(2, 19.5);
  boxes[0].lower.z = 12;
  boxes[0].upper.z = boxes[1].upper.z = 42;
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const CanOpenCell only_first = [](const Tube&, std::uint32_t from) { return from == 0; };
  const PlannedCellDrainage planned = plan(model, cells, request_of(), limits_of(), only_first);
  EXPECT_EQ(planned.kept.size(), 2U);
  ASSERT_GE(planned.plan.channels.size(), 2U);
  EXPECT_NEAR(planned.plan.channels[0].tube.start.z, 12 + 1.5 + kWindowMargin, 0.01);
  EXPECT_NEAR(planned.plan.channels[1].tube.start.z, 42 - 1.5 - kWindowMargin, 0.01);
  // The first void's hole, out of its side, is a little above its floor.
  EXPECT_GE(planned.plan.pools.upright, 19.5 * 20 * (10 + kWindowMargin) - 1e-3);
  EXPECT_LE(planned.plan.pools.upright, 19.5 * 20 * (10 + kWindowMargin + 0.1));
  EXPECT_LE(planned.plan.pools.after_both, 2 * 19.5 * 20 * 0.311);
}

// With a foot below and a head above the shared wall it cannot drain through that.
TEST(CellDrainage, AVoidThatStaysFullIsLeftOut) {
  std::vector<Box> boxes = equal_boxes(2, 19.5);
  boxes[0].lower.z = 12;
  boxes[1].upper.z = 32;
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const CanOpenCell only_first = [](const Tube&, std::uint32_t from) { return from == 0; };
  const PlannedCellDrainage planned = plan(model, cells, request_of(), limits_of(), only_first);
  EXPECT_EQ(planned.kept, (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(planned.dropped.full, 1U);
  EXPECT_TRUE(planned.plan.channels.empty());
  EXPECT_EQ(planned.plan.holes.size(), 2U);
  EXPECT_LE(planned.plan.pools.after_both, kPoolsAimedAt * planned.plan.pools.total);
}

TEST(CellDrainage, ARowIsJoinedFromOneToTheNext) {
  const std::vector<Box> boxes = equal_boxes(4, 14);
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const PlannedCellDrainage planned = plan(model, cells);
  EXPECT_EQ(planned.kept.size(), 4U);
  EXPECT_GE(planned.plan.channels.size(), 3U);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> joined;
  for (const Channel& channel : planned.plan.channels) joined.emplace_back(channel.from, channel.to);
  std::sort(joined.begin(), joined.end());
  joined.erase(std::unique(joined.begin(), joined.end()), joined.end());
  EXPECT_EQ(joined, (std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {1, 2}, {2, 3}}));
  EXPECT_LE(planned.plan.pools.after_both, kPoolsAimedAt * planned.plan.pools.total);
  expect_sound(model, cells, planned, boxes);
}

TEST(CellDrainage, AVoidWithoutAFaceForAWindowIsLeftOutAsNarrow) {
  std::vector<Box> boxes = equal_boxes(3, 16);
  boxes[2] = {{boxes[2].lower.x, 2, 2}, {boxes[2].lower.x + 3.5, 22, 5.2}};  // 3.2 mm high
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const PlannedCellDrainage planned = plan(model, cells);
  EXPECT_EQ(planned.kept, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(planned.dropped.narrow, 1U);
  EXPECT_EQ(planned.dropped.count(), 1U);
  EXPECT_NEAR(planned.dropped.volume, 3.5 * 20 * 3.2, 1e-3);
}

// Holes of 6 mm find no place in a void of 5 mm.
TEST(CellDrainage, WhereNoHoleOfTheUsualWidthFitsNarrowerOnesAreMade) {
  std::vector<Box> boxes = equal_boxes(1, 5);
  boxes[0].upper = {7, 7, 7};
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  DrainageRequest request = request_of();
  request.hole_radius = 3;
  EXPECT_THROW(plan(model, cells, request, limits_of()), NothingToRemoveError);
  request.narrow_hole_radius = 1.5;
  const PlannedCellDrainage planned = plan(model, cells, request, limits_of());
  ASSERT_EQ(planned.plan.holes.size(), 2U);
  for (const EscapeHole& hole : planned.plan.holes) EXPECT_EQ(hole.tube.radius, 1.5);
}

// A level tube of any width has a top that the printer bridges.
TEST(CellDrainage, WhereCeilingsAreLimitedWideHolesMayLeadOutSideways) {
  const std::vector<Box> boxes = equal_boxes(1, 30);
  const Mesh model = block_round(boxes);
  PackingLimits limits = limits_of();
  limits.roof = make_roof({.degrees = 45, .bridge = 1, .up = {0, 0, 1}});
  const CanOpenCell only_level = [](const Tube& tube, std::uint32_t) {
    return std::abs(direction_of(tube).z) < 0.1;
  };
  const PlannedCellDrainage planned = plan(model, row_of(boxes), request_of(), limits, only_level);
  ASSERT_EQ(planned.plan.holes.size(), 2U);
  for (const EscapeHole& hole : planned.plan.holes) EXPECT_FALSE(is_bridged(hole.tube, limits.roof));
}

TEST(CellDrainage, OneVoidAloneIsOpenedBelowAndAbove) {
  for (const Vec3d up : {Vec3d{0, 0, 1}, Vec3d{0, -1, 0}, Vec3d{1, 0, 0}}) {
    const std::vector<Box> boxes = equal_boxes(1, 30);
    const Mesh model = block_round(boxes);
    const CellVoids cells = row_of(boxes);
    const PlannedCellDrainage planned = plan(model, cells, request_of(), limits_of(up));
    ASSERT_EQ(planned.plan.holes.size(), 2U);
    const auto height = [&](std::size_t i) { return dot(planned.plan.holes[i].tube.end, up); };
    EXPECT_GT(height(1), height(0) + 20);
    EXPECT_NEAR(planned.plan.pools.upright, 0, 1e-6);
    EXPECT_NEAR(planned.plan.pools.after_both, 0, 1e-6);
    expect_sound(model, cells, planned, boxes);
  }
}

TEST(CellDrainage, HolesThatAreAskedForAreWhereTheyAreAskedFor) {
  const std::vector<Box> boxes = equal_boxes(2, 19.5);
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const PlannedCellDrainage planned = plan(model, cells, request_of({{10, 0, 8}, {30, 12, 24}}));
  ASSERT_EQ(planned.plan.holes.size(), 2U);
  EXPECT_LT(length(planned.plan.holes[0].tube.end - Vec3d{10, 0, 8}), 1.5);
  EXPECT_LT(length(planned.plan.holes[1].tube.end - Vec3d{30, 12, 24}), 1.5);
  expect_sound(model, cells, planned, boxes);
  EXPECT_THROW(plan(model, cells, request_of({{10, -9, 8}})), UsageError);
}

// The end of a bar is too far from any void for a hole. The place that the refusal names is one that is taken.
TEST(CellDrainage, WhereNoHoleOpensTheNearestPlaceIsSaid) {
  const std::vector<Box> boxes = equal_boxes(2, 19.5);
  const Mesh bar = make_box({0, 0, 0}, {200, 24, 24});
  const CellVoids cells = row_of(boxes);
  const auto refused = [&](Vec3d place) {
    return message_of<UsageError>([&] { plan(bar, cells, request_of({place})); });
  };
  const Vec3d asked{60, 12, 24};
  const auto place = place_said_in(refused(asked));
  ASSERT_TRUE(place.has_value());
  EXPECT_LT(length(*place - asked), 18);
  const PlannedCellDrainage planned = plan(bar, cells, request_of({*place}));
  EXPECT_LT(length(planned.plan.holes[0].tube.end - *place), 1.5);
  const std::string far_away = refused({180, 12, 24});
  EXPECT_FALSE(place_said_in(far_away).has_value());
  EXPECT_TRUE(contains(far_away, "--hole-diameter"));
}

// Of three boxes the one in the middle begins 10 mm higher. One of the others drains by a hole in its floor; what of the last is below
// its window each layer closes in, and at the window's sill, which is that of the other window too, the floor of the middle one with it.
TEST(CellDrainage, WhereALayerWouldCloseInTooMuchAHoleIsAdded) {
  std::vector<Box> boxes = equal_boxes(3, 19.5);
  boxes[1].lower.z = 12;
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const PlannedCellDrainage usual = plan(model, cells);
  ASSERT_EQ(usual.plan.holes.size(), 2U);
  EXPECT_NEAR(usual.plan.widest_cup, 2 * 19.5 * 20, 0.02 * 19.5 * 20);
  DrainageRequest request = request_of();
  request.widest_cup = 100;
  const PlannedCellDrainage planned = plan(model, cells, request, limits_of());
  expect_sound(model, cells, planned, boxes);
  ASSERT_EQ(planned.plan.holes.size(), 3U);
  EXPECT_EQ(planned.plan.holes[2].purpose, HolePurpose::cup);
  EXPECT_NE(planned.plan.holes[2].from, planned.plan.holes[0].from);
  EXPECT_NEAR(planned.plan.holes[2].tube.end.z, 0, 1e-6);
  EXPECT_LE(planned.plan.widest_cup, 100);
  // What is allowed adds nothing, nor does what no hole can be cut for.
  request.widest_cup = 800;
  EXPECT_EQ(plan(model, cells, request, limits_of()).plan.holes.size(), 2U);
  request.widest_cup = 100;
  const CanOpenCell only_first = [](const Tube&, std::uint32_t from) { return from == 0; };
  EXPECT_EQ(plan(model, cells, request, limits_of(), only_first).plan.holes.size(), 2U);
}

TEST(CellDrainage, HolesThatCannotBeCutAreNotMade) {
  const std::vector<Box> boxes = equal_boxes(2, 19.5);
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const CanOpenCell not_below = [](const Tube& tube, std::uint32_t) { return tube.end.z > 0.01; };
  const PlannedCellDrainage planned = plan(model, cells, request_of(), limits_of(), not_below);
  for (const EscapeHole& hole : planned.plan.holes) EXPECT_GT(hole.tube.end.z, 0.01);
  EXPECT_THROW(
      plan(model, cells, request_of(), limits_of(), [](const Tube&, std::uint32_t) { return false; }),
      NothingToRemoveError);
}

// A box with rounded edges, facing inwards. Its faces' middles are flat, exactly.
Mesh rounded_box(const Box& box, double radius) {
  constexpr int kSteps = 4;
  const auto lines = [&](double lower, double upper) {
    std::vector<double> at;
    for (int i = 0; i <= kSteps; ++i) at.push_back(lower + radius * i / kSteps);
    for (int i = 0; i <= kSteps; ++i) at.push_back(upper - radius + radius * i / kSteps);
    return at;
  };
  const std::array<std::vector<double>, 3> grid{
      lines(box.lower.x, box.upper.x), lines(box.lower.y, box.upper.y), lines(box.lower.z, box.upper.z)};
  const Vec3d inset{radius, radius, radius};
  Mesh mesh;
  std::map<std::array<std::size_t, 3>, std::uint32_t> known;
  const auto vertex = [&](std::array<std::size_t, 3> i) {
    const auto [found, is_new] = known.try_emplace(i, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) {
      const Vec3d p{grid[0][i[0]], grid[1][i[1]], grid[2][i[2]]};
      const Vec3d core = max_of(box.lower + inset, min_of(box.upper - inset, p));
      mesh.positions.push_back(to_float(core + normalised(p - core) * radius));
    }
    return found->second;
  };
  constexpr std::size_t kLast = 2 * kSteps + 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const std::size_t end : {std::size_t{0}, kLast}) {
      for (std::size_t i = 0; i < kLast; ++i) {
        for (std::size_t j = 0; j < kLast; ++j) {
          const auto corner = [&](std::size_t di, std::size_t dj) {
            std::array<std::size_t, 3> at{};
            at[axis] = end;
            at[u] = i + di;
            at[v] = j + dj;
            return vertex(at);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (end == 0) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
          } else {
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({a, d, c});
          }
        }
      }
    }
  }
  return mesh;
}

struct Block {
  std::vector<Box> boxes;
  CellVoids cells;
};

// Rounded boxes in three directions, each a cell.
Block block_of(std::array<int, 3> counts, double width, double radius) {
  Block block;
  block.cells.lattice = kLattice;
  block.cells.ball_radius = radius;
  block.cells.planes.first.push_back(0);
  const auto number = [&](int x, int y, int z) {
    return static_cast<std::uint32_t>((z * counts[1] + y) * counts[0] + x);
  };
  const auto from = [&](int i) { return kWall + i * (width + kGap); };
  const std::array<Vec3d, 3> axes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  for (int z = 0; z < counts[2]; ++z) {
    for (int y = 0; y < counts[1]; ++y) {
      for (int x = 0; x < counts[0]; ++x) {
        const Box box{{from(x), from(y), from(z)}, {from(x) + width, from(y) + width, from(z) + width}};
        const std::array<int, 3> at{x, y, z};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          for (const int side : {-1, 1}) {
            std::array<int, 3> next = at;
            next[axis] += side;
            if (next[axis] < 0 || next[axis] >= counts[axis]) continue;
            const Vec3d normal = axes[axis] * side;
            block.cells.planes.planes.push_back(
                {normal, dot(normal, side > 0 ? box.upper : box.lower), number(next[0], next[1], next[2])});
          }
        }
        block.cells.planes.first.push_back(static_cast<std::uint32_t>(block.cells.planes.planes.size()));
        block.cells.planes.boxes.push_back({box.lower, box.upper});
        CellVoid one;
        one.cell = number(x, y, z);
        one.surface = rounded_box(box, radius);
        one.planned_volume = -signed_volume(one.surface);
        const Vec3d inset{radius, radius, radius};
        one.nodes = runs_where(box, [&](Vec3d p) {
          const Vec3d core = max_of(box.lower + inset, min_of(box.upper - inset, p));
          return length(p - core) < radius;
        });
        block.cells.voids.push_back(std::move(one));
        block.boxes.push_back(box);
      }
    }
  }
  return block;
}

TEST(CellDrainage, ABlockOfRoundedCellsDrainsToAHundredth) {
  for (const Vec3d up : {normalised(Vec3d{1, 1, 1}), normalised(Vec3d{0.3, -0.5, 0.8})}) {
    const Block block = block_of({3, 3, 3}, 12, 1.5);
    ASSERT_GT(block.cells.voids[0].planned_volume, 1600);
    const Mesh model = block_round(block.boxes);
    const PlannedCellDrainage planned = plan(model, block.cells, request_of(), limits_of(up));
    EXPECT_LE(planned.plan.pools.after_both, kPoolsAimedAt * planned.plan.pools.total);
    EXPECT_EQ(planned.kept.size(), block.boxes.size());
    EXPECT_EQ(planned.plan.holes.size(), 2U);
    EXPECT_EQ(planned.plan.network_count, 1U);
    expect_sound(model, block.cells, planned, block.boxes);
    for (const Channel& channel : planned.plan.channels) {
      const std::uint32_t from = planned.kept[channel.from], to = planned.kept[channel.to];
      EXPECT_TRUE(block.boxes[from].holds(channel.tube.start));
      EXPECT_TRUE(block.boxes[to].holds(channel.tube.end));
      for (std::uint32_t i = 0; i < block.boxes.size(); ++i) {
        if (i == from || i == to) continue;
        EXPECT_GE(distance_to(block.cells.voids[i].surface, {channel.tube.start, channel.tube.end}),
                  channel.tube.radius + kGap - 1e-6);
      }
    }
    for (std::size_t i = 0; i < planned.plan.channels.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Tube &a = planned.plan.channels[i].tube, &b = planned.plan.channels[j].tube;
        EXPECT_GE(distance_between({a.start, a.end}, {b.start, b.end}), 2.4 * 1.5 - 1e-9);
      }
    }
  }
}

TEST(CellDrainage, IsTheSameEachTime) {
  const std::vector<Box> boxes = equal_boxes(4, 14);
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const PlannedCellDrainage one = plan(model, cells), two = plan(model, cells);
  ASSERT_EQ(one.plan.holes.size(), two.plan.holes.size());
  ASSERT_EQ(one.plan.channels.size(), two.plan.channels.size());
  for (std::size_t i = 0; i < one.plan.holes.size(); ++i) {
    EXPECT_TRUE(one.plan.holes[i].tube.start == two.plan.holes[i].tube.start);
    EXPECT_TRUE(one.plan.holes[i].tube.end == two.plan.holes[i].tube.end);
  }
  for (std::size_t i = 0; i < one.plan.channels.size(); ++i)
    EXPECT_TRUE(one.plan.channels[i].tube.start == two.plan.channels[i].tube.start);
  EXPECT_EQ(one.plan.pools.after_both, two.plan.pools.after_both);
}

}  // namespace
}  // namespace aerate::test
