#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <queue>
#include <random>
#include <utility>
#include <vector>

#include "kernels/constants.h"
#include "packing/cells/cell_drainage_flow.h"
#include "packing/cells/cell_drainage_pools.h"
#include "packing/cells/node_pools.h"
#include "tests/packing/cell_boxes.h"

namespace aerate::test {
namespace {

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
    balls.reserve(12);
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
    const std::vector<VoidHollows> hollows{VoidHollows(nodes, up, count, Mesh{})};
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
  const VoidHollows hollows(coarse, {0, 0, 1}, 350, Mesh{});
  ASSERT_EQ(hollows.in(kUpright).size(), 1U);
  EXPECT_NEAR(piece_below(hollows.pieces()[0], kUpright, 4), 10 * 7 * 2, 1e-9);
  EXPECT_NEAR(piece_below(hollows.pieces()[0], kUpsideDown, -4), 10 * 7 * 3, 1e-9);
}

// Floors and ceilings are where the surface is, wherever the nodes lie below and above it, for any axis that is up.
TEST(NodePools, BeginAtTheFloorOfTheSurface) {
  for (const double off : {0.05, 0.2, 0.3, 0.45}) {
    const CellVoid box = box_void(0, {{2 + off, 2 + off, 2 + off}, {12.4, 9.4, 7.4}});
    const Vec3d size{10.4 - off, 7.4 - off, 5.4 - off};
    const double volume = size.x * size.y * size.z;
    const auto pieces_along = [&](Vec3d up) {
      const VoidHollows hollows(nodes_of(box, kLattice, 0), up, volume, box.surface);
      EXPECT_EQ(hollows.pieces().size(), 1U);
      return hollows.pieces()[0];
    };
    // Spans are kept in steps of 1/64 of a spacing.
    const double step = kSpacing / 64;
    const VoidHollows::Piece z = pieces_along({0, 0, 1}), x = pieces_along({1, 0, 0}),
                             turned = pieces_along({0, -1, 0});
    EXPECT_NEAR(piece_below(z, kUpright, 2 + off), 0, step * size.x * size.y) << off;
    EXPECT_NEAR(piece_below(z, kUpright, 5), size.x * size.y * (3 - off), step * size.x * size.y) << off;
    EXPECT_NEAR(piece_below(z, kUpsideDown, -7.4), 0, step * size.x * size.y) << off;
    EXPECT_NEAR(piece_below(x, kUpright, 2 + off), 0, step * size.y * size.z) << off;
    EXPECT_NEAR(piece_below(x, kUpsideDown, -7), 5.4 * size.y * size.z, step * size.y * size.z) << off;
    EXPECT_NEAR(piece_below(turned, kUpright, -9.4), 0, step * size.x * size.z) << off;
    EXPECT_NEAR(piece_below(turned, kUpright, -5), 4.4 * size.x * size.z, step * size.x * size.z) << off;
  }
}

// Two feet below a block: each is a hollow of its own, and what runs out of one leaves the other full.
TEST(NodePools, OfTwoFeetAreCountedOneByOne) {
  const Box body{{2, 2, 7}, {32, 12, 17}}, left{{2, 2, 2}, {10, 12, 8}}, right{{22, 2, 4}, {32, 12, 8}};
  CellVoid feet;
  feet.nodes = runs_where({{2, 2, 2}, {32, 12, 17}},
                          [&](Vec3d p) { return body.holds(p) || left.holds(p) || right.holds(p); });
  const double volume = 30 * 10 * 10 + 8 * 10 * 5 + 10 * 10 * 3;
  const std::vector<VoidHollows> hollows{VoidHollows(nodes_of(feet, kLattice, 0), {0, 0, 1}, volume, Mesh{})};
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

}  // namespace
}  // namespace aerate::test
