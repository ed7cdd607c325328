#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <queue>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/segment_distance.h"
#include "packing/cell_drainage.h"
#include "packing/cell_drainage_faces.h"
#include "packing/cell_drainage_flow.h"
#include "packing/cell_drainage_pools.h"
#include "packing/cell_windows.h"
#include "packing/node_pools.h"
#include "tests/support/caught.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

constexpr double kWall = 2, kGap = 1, kSpacing = 0.5;
const NodeLattice kLattice{{0.25, 0.25, 0.25}, kSpacing};

struct Box {
  Vec3d lower, upper;
  bool holds(Vec3d p) const {
    return p.x > lower.x && p.y > lower.y && p.z > lower.z && p.x < upper.x && p.y < upper.y && p.z < upper.z;
  }
};

std::vector<NodeRun> runs_where(const Box& within, const std::function<bool(Vec3d)>& is_inside) {
  const auto index = [](double x) { return static_cast<std::int32_t>(std::floor(x / kSpacing)); };
  std::vector<NodeRun> runs;
  for (std::int32_t z = index(within.lower.z); z <= index(within.upper.z); ++z) {
    for (std::int32_t y = index(within.lower.y); y <= index(within.upper.y); ++y) {
      for (std::int32_t x = index(within.lower.x); x <= index(within.upper.x); ++x) {
        if (!is_inside(kLattice.at(x, y, z))) continue;
        const bool goes_on =
            !runs.empty() && runs.back().z == z && runs.back().y == y && runs.back().last == x - 1;
        if (goes_on)
          runs.back().last = x;
        else
          runs.push_back({x, x, y, z});
      }
    }
  }
  return runs;
}

// A void that is a box.
CellVoid box_void(std::uint32_t cell, const Box& box) {
  CellVoid result;
  result.cell = cell;
  result.surface = test::turned_inside_out(test::make_box(to_float(box.lower), to_float(box.upper)));
  result.planned_volume = -signed_volume(result.surface);
  result.nodes = runs_where(box, [&](Vec3d p) { return box.holds(p); });
  return result;
}

// Boxes in a row along x, a gap apart: each is a cell.
CellVoids row_of(const std::vector<Box>& boxes) {
  CellVoids cells;
  cells.lattice = kLattice;
  cells.ball_radius = 1.5;
  cells.planes.first.push_back(0);
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (i > 0) cells.planes.planes.push_back({{-1, 0, 0}, -boxes[i].lower.x, i - 1});
    if (i + 1 < boxes.size()) cells.planes.planes.push_back({{1, 0, 0}, boxes[i].upper.x, i + 1});
    cells.planes.first.push_back(static_cast<std::uint32_t>(cells.planes.planes.size()));
    cells.planes.boxes.push_back({boxes[i].lower, boxes[i].upper});
    cells.voids.push_back(box_void(i, boxes[i]));
  }
  return cells;
}

std::vector<Box> equal_boxes(int count, double width) {
  std::vector<Box> boxes;
  for (int i = 0; i < count; ++i) {
    const double from = kWall + i * (width + kGap);
    boxes.push_back({{from, kWall, kWall}, {from + width, kWall + 20, kWall + 20}});
  }
  return boxes;
}

Mesh block_round(const std::vector<Box>& boxes) {
  Box all = boxes.front();
  for (const Box& box : boxes) all = {min_of(all.lower, box.lower), max_of(all.upper, box.upper)};
  const Vec3d wall{kWall, kWall, kWall};
  return test::make_box(to_float(all.lower - wall), to_float(all.upper + wall));
}

DrainageRequest request_of(std::vector<Vec3d> holes = {}) {
  return {.channel_radius = 1.5, .hole_radius = 1.5, .escape_holes = std::move(holes)};
}

PackingLimits limits_of(Vec3d up = {0, 0, 1}) {
  PackingLimits limits{.wall = kWall, .gap = kGap};
  limits.roof.up = up;
  return limits;
}

const CanOpenCell kAlways = [](const Tube&, std::uint32_t) { return true; };

PlannedCellDrainage plan(const Mesh& model, const CellVoids& cells,
                         const DrainageRequest& request = request_of(),
                         const PackingLimits& limits = limits_of(), const CanOpenCell& can_open = kAlways) {
  const SurfaceIndex surface(model);
  Monitor monitor;
  return plan_cell_drainage(
      {surface, surface.winding()}, cells, limits, request, can_open, [](const Tube&) { return true; },
      monitor);
}

double distance_to(const Mesh& mesh, const Segment& segment) {
  double nearest = 1e300;
  for (const Triangle& t : mesh.triangles)
    nearest = std::min(nearest, distance_to_facet(segment, facet_of(mesh, t)));
  return nearest;
}

// Every hole begins in its void and ends on the surface; at its side all but the last bit keeps the wall, and
// it keeps the gap from other voids.
void expect_sound(const Mesh& model, const CellVoids& cells, const PlannedCellDrainage& planned,
                  const std::vector<Box>& boxes) {
  for (const EscapeHole& hole : planned.plan.holes) {
    const std::uint32_t from = planned.kept.at(hole.from);
    EXPECT_TRUE(boxes.at(from).holds(hole.tube.start));
    EXPECT_NEAR(distance_to(model, {hole.tube.end, hole.tube.end}), 0, 1e-4);
    for (std::uint32_t i = 0; i < cells.voids.size(); ++i) {
      if (i == from) continue;
      EXPECT_GE(distance_to(cells.voids[i].surface, {hole.tube.start, hole.tube.end}),
                hole.tube.radius + kGap - 1e-6);
    }
    // Each point of the axis is farther from the surface than half its way to the end, or keeps the wall.
    for (int k = 0; k < 20; ++k) {
      const Vec3d p = hole.tube.start + (hole.tube.end - hole.tube.start) * (k / 20.0);
      const double needed = std::min(hole.tube.radius + kWall, 0.5 * length(hole.tube.end - p));
      EXPECT_GE(distance_to(model, {p, p}), needed - 0.03);
    }
  }
  for (std::size_t i = 0; i < planned.plan.holes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Tube &a = planned.plan.holes[i].tube, &b = planned.plan.holes[j].tube;
      EXPECT_GE(distance_between({a.start, a.end}, {b.start, b.end}), a.radius + b.radius + 0.5);
    }
  }
}

// What brute force over all nodes finds: the volume of those that lie lower than liquid has to rise to leave
// through some of them.
double stays_by_brute_force(const VoidNodes& nodes, Vec3d up, const std::vector<std::uint32_t>& outlets) {
  const auto height = [&](std::uint32_t node) { return dot(nodes.at(node), up); };
  std::vector<double> spill(nodes.size(), 1e300);
  using Step = std::pair<double, std::uint32_t>;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
  for (const std::uint32_t node : outlets) open.push({height(node), node});
  while (!open.empty()) {
    const auto [level, node] = open.top();
    open.pop();
    if (spill[node] <= level) continue;
    spill[node] = level;
    const Vec3d p = (nodes.at(node) - nodes.lattice.origin) * (1 / nodes.lattice.spacing);
    const auto at = [&](int dx, int dy, int dz) {
      return nodes.number_of(static_cast<std::int32_t>(std::lround(p.x)) + dx,
                             static_cast<std::int32_t>(std::lround(p.y)) + dy,
                             static_cast<std::int32_t>(std::lround(p.z)) + dz);
    };
    for (const std::uint32_t next :
         {at(1, 0, 0), at(-1, 0, 0), at(0, 1, 0), at(0, -1, 0), at(0, 0, 1), at(0, 0, -1)}) {
      if (next != kNone) open.push({std::max(level, height(next)), next});
    }
  }
  double stays = 0;
  for (std::uint32_t i = 0; i < nodes.size(); ++i) stays += spill[i] > height(i) + 1e-9 ? 1 : 0;
  return stays;
}

TEST(NodePools, AreThoseOfBruteForceInAnyShape) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  for (int shape = 0; shape < 12; ++shape) {
    std::vector<std::pair<Vec3d, double>> balls;
    for (int i = 0; i < 12; ++i)
      balls.push_back(
          {{15 * share(random), 15 * share(random), 15 * share(random)}, 1.5 + 2 * share(random)});
    CellVoid blob;
    blob.nodes = runs_where({{-5, -5, -5}, {20, 20, 20}}, [&](Vec3d p) {
      return std::any_of(balls.begin(), balls.end(),
                         [&](const auto& ball) { return length(p - ball.first) < ball.second; });
    });
    // What the first node hangs together with.
    VoidNodes nodes = nodes_of(blob, kLattice, 0);
    const Vec3d up = shape % 3 == 0 ? Vec3d{0, 0, 1} : shape % 3 == 1 ? Vec3d{1, 0, 0} : Vec3d{0, -1, 0};
    const auto count = static_cast<double>(nodes.size());
    const std::vector<VoidHollows> hollows{VoidHollows(nodes, up, count)};
    const CellPools pools(hollows);
    for (const std::size_t orientation : {kUpright, kUpsideDown}) {
      const auto outlet = static_cast<std::uint32_t>(share(random) * (count - 1));
      const Vec3d own_up = orientation == kUpright ? up : -up;
      Passage passage{.sill = {}, .mouths = {}};
      passage.sill[orientation] = dot(nodes.at(outlet), own_up) - kSpacing / 2;  // its lower side
      passage.mouths[0].into = 0;
      passage.mouths[0].hollows[orientation] = {hollows[0].in(orientation).of_node[outlet]};
      const HollowFlood flood = pools.flood({&passage}, orientation);
      const double stays = pools.stays_in(flood, orientation).front();
      const double expected = stays_by_brute_force(nodes, own_up, {outlet});
      // Nodes that do not hang together with the outlet run over at the void's top here.
      const double apart = expected - stays;
      EXPECT_GE(apart, -1e-6);
      EXPECT_LE(apart, 0.02 * count) << shape;
    }
  }
}

TEST(NodePools, KeepVolumeAndConnectionWhenNodesArePutTogether) {
  const CellVoid box = box_void(0, {{2, 2, 2}, {12, 9, 7}});
  const VoidNodes fine = nodes_of(box, kLattice, 0), coarse = nodes_of(box, kLattice, 1);
  std::size_t sum = 0;
  for (const std::uint16_t weight : coarse.weights) sum += weight;
  EXPECT_EQ(sum, fine.size());
  EXPECT_EQ(coarse.size() * 8, fine.size());
  const VoidHollows hollows(coarse, {0, 0, 1}, 350);
  ASSERT_EQ(hollows.in(kUpright).size(), 1U);
  EXPECT_NEAR(piece_below(hollows.pieces()[0], kUpright, 4), 10 * 7 * 2, 1e-9);
  EXPECT_NEAR(piece_below(hollows.pieces()[0], kUpsideDown, -4), 10 * 7 * 3, 1e-9);
}

// Two feet below a block: each is a hollow of its own, and what runs out of one leaves the other full.
TEST(NodePools, OfTwoFeetAreCountedOneByOne) {
  const Box body{{2, 2, 7}, {32, 12, 17}}, left{{2, 2, 2}, {10, 12, 8}}, right{{22, 2, 4}, {32, 12, 8}};
  CellVoid feet;
  feet.nodes = runs_where({{2, 2, 2}, {32, 12, 17}},
                          [&](Vec3d p) { return body.holds(p) || left.holds(p) || right.holds(p); });
  const double volume = 30 * 10 * 10 + 8 * 10 * 5 + 10 * 10 * 3;
  const std::vector<VoidHollows> hollows{VoidHollows(nodes_of(feet, kLattice, 0), {0, 0, 1}, volume)};
  ASSERT_EQ(hollows[0].in(kUpright).size(), 3U);
  EXPECT_EQ(hollows[0].in(kUpsideDown).size(), 1U);
  const CellPools pools(hollows);
  const auto hole_at = [&](Vec3d p, double sill) {
    Passage passage{.sill = {sill, -sill}, .mouths = {}};
    passage.mouths[0].into = 0;
    for (const std::size_t orientation : {kUpright, kUpsideDown})
      passage.mouths[0].hollows[orientation] =
          hollows[0].hollows_near({p, p}, 1, passage.sill[orientation], orientation);
    return passage;
  };
  const Passage below_left = hole_at({6, 7, 2}, 2), below_right = hole_at({27, 7, 4}, 4);
  const std::vector<char> kept{1};
  EXPECT_NEAR(pools.measure({&below_left}, kept).upright, 10 * 10 * 3, 1e-6);
  EXPECT_NEAR(pools.measure({&below_right}, kept).upright, 8 * 10 * 5, 1e-6);
  EXPECT_NEAR(pools.measure({&below_left, &below_right}, kept).upright, 0, 1e-6);
  // Upside down all but what is above the lower hole's height stays.
  const TrappedPools one = pools.measure({&below_right}, kept);
  EXPECT_NEAR(one.upside_down, volume - 8 * 10 * 2, 1e-6);
  EXPECT_NEAR(one.after_both, 8 * 10 * 5, 1e-6);
  EXPECT_NEAR(one.total, volume, 1e-9);
}

TEST(FreeFlows, AreLimitedByTheNarrowestCut) {
  FreeFlow flow(4);
  flow.supply(0, 5);
  flow.supply(1, 2);
  flow.demand(2, 3);
  flow.demand(3, 10);
  flow.connect(0, 2);
  flow.connect(1, 2);
  flow.connect(1, 3);
  EXPECT_NEAR(flow.most(), 5, 1e-12);
}

TEST(DiscPlaces, AreTheLowestAndTheHighestExactly) {
  const Mesh surface = test::make_box({0, 0, 0}, {10, 8, 6});
  const CellPlane plane{{1, 0, 0}, 10, 0};
  const TubeFrame frame = frame_of({{0, 0, 0}, plane.normal, 1}, {0, 0, 1});
  const FlatFace face = flat_face(surface, plane, frame);
  ASSERT_EQ(face.triangles.size(), 2U);
  ASSERT_EQ(face.rim.size(), 4U);
  const DiscPlaces places(face, face, 1.3, 0.17);
  const std::vector<Flat> chosen = places.choose(2, false);
  ASSERT_GE(chosen.size(), 3U);
  EXPECT_NEAR(dot(frame.down * chosen[0].y, Vec3d{0, 0, 1}), 1.3, 0.01);
  EXPECT_NEAR(dot(frame.down * chosen[1].y, Vec3d{0, 0, 1}), 6 - 1.3, 0.01);
  EXPECT_TRUE(DiscPlaces(face, face, 3.01, 0.17).choose(2, false).empty());
}

TEST(CellDrainage, AWindowLiesAsLowAsBothFacesAllow) {
  std::vector<Box> boxes = equal_boxes(2, 19.5);
  boxes[1].lower.z = 5;  // its face begins higher
  const Mesh model = block_round(boxes);
  const CellVoids cells = row_of(boxes);
  const PlannedCellDrainage planned = plan(model, cells);
  ASSERT_EQ(planned.kept, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(planned.dropped.count(), 0U);
  ASSERT_FALSE(planned.plan.channels.empty());
  const Channel& window = planned.plan.channels.front();
  EXPECT_EQ(std::pair(window.from, window.to), std::pair(0U, 1U));
  EXPECT_NEAR(window.tube.start.x, 21.25, 1e-6);
  EXPECT_NEAR(window.tube.end.x, 22.75, 1e-6);
  EXPECT_NEAR(window.tube.start.y, window.tube.end.y, 1e-9);
  EXPECT_NEAR(window.tube.start.z, 5 + 1.5 + kWindowMargin, 0.01);
  EXPECT_NEAR(window.tube.end.z, window.tube.start.z, 1e-9);
  expect_sound(model, cells, planned, boxes);
  EXPECT_EQ(planned.plan.network_count, 1U);
  EXPECT_EQ(planned.plan.holes.size(), 2U);
}

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

// A box of which the right or left face leans: x changes by `lean` for each millimetre of z.
Mesh leaning_box(const Box& box, bool leans_right, double lean) {
  Mesh mesh = test::turned_inside_out(test::make_box(to_float(box.lower), to_float(box.upper)));
  for (Vec3f& p : mesh.positions) {
    const Vec3d at = to_double(p);
    if (at.x == (leans_right ? box.upper.x : box.lower.x))
      p = to_float(at + Vec3d{lean * (at.z - box.lower.z), 0, 0});
  }
  return mesh;
}

TEST(CellDrainage, AWindowInALeaningWallIsPerpendicularToIt) {
  constexpr double kLean = 0.75;
  const Vec3d normal{0.8, 0, -0.6};
  std::vector<Box> boxes{{{2, 2, 2}, {22, 22, 22}}, {{23.25, 2, 2}, {50, 22, 22}}};  // a gap apart
  CellVoids cells = row_of(boxes);
  for (std::uint32_t i = 0; i < 2; ++i) {
    cells.voids[i].surface = leaning_box(boxes[i], i == 0, kLean);
    const Vec3d on_face = i == 0 ? Vec3d{22, 0, 2} : Vec3d{23.25, 0, 2};
    CellPlane& plane = cells.planes.planes[i];
    plane.normal = i == 0 ? normal : -normal;
    plane.offset = dot(plane.normal, on_face);
    Box around = boxes[i];
    around.upper.x = 50;
    cells.voids[i].nodes =
        runs_where(around, [&](Vec3d p) { return around.holds(p) && dot(plane.normal, p) < plane.offset; });
  }
  const Mesh model = block_round(boxes);
  const PlannedCellDrainage planned = plan(model, cells);
  ASSERT_EQ(planned.kept.size(), 2U);
  ASSERT_GE(planned.plan.channels.size(), 1U);
  for (const Channel& channel : planned.plan.channels) {
    EXPECT_NEAR(dot(direction_of(channel.tube), normal), 1, 1e-9);
    EXPECT_NEAR(dot(normal, channel.tube.start), cells.planes.planes[0].offset - 0.25, 1e-6);
    EXPECT_NEAR(dot(normal, channel.tube.end), cells.planes.planes[0].offset + 1.25, 1e-6);
  }
  // On the first face the lower edge of the second shows 0.6 mm higher, along the wall 0.75.
  const Tube& tube = planned.plan.channels[0].tube;
  const double on_face = tube.start.z - 0.25 * 0.6 - 2;
  EXPECT_NEAR(on_face, (1.5 + kWindowMargin + 0.75) * 0.8, 0.01);
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
}  // namespace aerate
