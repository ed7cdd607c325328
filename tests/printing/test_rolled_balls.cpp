#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <gtest/gtest.h>
#include <vector>

#include "core/surface_index.h"
#include "printing/cells/cell_nodes.h"
#include "printing/cells/rolled_balls.h"
#include "tests/support/shapes.h"

namespace aerate {
namespace {

constexpr std::int32_t kCount = 8;

// Nodes of a lattice of 1 mm of which no one has a ball.
CellNodes solid_nodes(double ball_radius) {
  CellNodes nodes;
  nodes.box.lattice = {.origin = {-4, -4, -4}, .spacing = 1};
  nodes.box.count_x = nodes.box.count_y = nodes.box.count_z = kCount;
  nodes.ball_radius = ball_radius;
  nodes.deepest = ball_radius + 2;
  nodes.depth.assign(nodes.box.size(), -1.F);
  nodes.surface_depth.assign(nodes.box.size(), 1e9F);
  nodes.facet.assign(nodes.box.size(), kNone);
  return nodes;
}

// The void's nodes of those that have a ball which holds no other node.
std::vector<std::size_t> void_of(const std::vector<std::array<std::int32_t, 3>>& places) {
  constexpr float kRadius = 0.2F;
  CellNodes nodes = solid_nodes(static_cast<double>(kRadius));
  for (const auto& [i, j, k] : places) nodes.depth[nodes.box.index(i, j, k)] = kRadius;
  const SurfaceIndex surface(test::make_box({-20, -20, -20}, {20, 20, 20}));
  const NearFacets near(surface.bvh());
  const CellRegion region({}, surface, near, 2);
  Monitor silent;
  SharedWork work(silent);
  const OpenedCell opened = open_cell(region, nodes, {{0, 0, 0}, 0.1, SphereKind::adaptive}, work);
  std::vector<std::size_t> result;
  for (std::size_t node = 0; node < opened.is_void.size(); ++node)
    if (opened.is_void[node] != 0) result.push_back(node);
  return result;
}

}  // namespace

TEST(RolledBalls, NodesSideBySideAreAVoid) {
  EXPECT_EQ(void_of({{3, 3, 3}, {4, 3, 3}}).size(), 2);
}

TEST(RolledBalls, BallsThatOnlyMeetDiagonallyAreNoVoid) {
  EXPECT_TRUE(void_of({{3, 3, 3}, {4, 4, 3}}).empty());
  EXPECT_TRUE(void_of({{3, 3, 3}, {4, 4, 4}}).empty());
}

TEST(RolledBalls, WhatIsBesideADiagonalStays) {
  // (5, 3, 3) hangs together with (5, 4, 3) alone, which meets (4, 5, 3) diagonally.
  const NodeBox box = solid_nodes(1).box;
  EXPECT_EQ(void_of({{5, 3, 3}, {5, 4, 3}, {4, 5, 3}}), std::vector<std::size_t>{box.index(5, 3, 3)});
}

TEST(CellNodes, SquaredDistancesAreThoseToTheNearestNodeOfTheSet) {
  NodeBox box;
  box.count_x = 9;
  box.count_y = 7;
  box.count_z = 8;
  const std::vector<std::array<std::int32_t, 3>> set{{1, 2, 3}, {7, 5, 6}, {8, 0, 0}};
  constexpr std::int32_t kMost = 4;
  std::vector<std::uint8_t> is_in_set(box.size(), 0);
  for (const auto& [x, y, z] : set) is_in_set[box.index(x, y, z)] = 1;
  Monitor silent;
  SharedWork work(silent);
  const std::vector<std::int32_t> squared = squared_distances(box, is_in_set, kMost, work);
  int near = 0;
  for (std::int32_t k = 0; k < box.count_z; ++k) {
    for (std::int32_t j = 0; j < box.count_y; ++j) {
      for (std::int32_t i = 0; i < box.count_x; ++i) {
        std::int32_t least = kFarAway;
        for (const auto& [x, y, z] : set) {
          if (std::max({std::abs(x - i), std::abs(y - j), std::abs(z - k)}) <= kMost)
            least = std::min(least, (x - i) * (x - i) + (y - j) * (y - j) + (z - k) * (z - k));
        }
        EXPECT_EQ(squared[box.index(i, j, k)], least) << i << ' ' << j << ' ' << k;
        near += least < kFarAway ? 1 : 0;
      }
    }
  }
  EXPECT_GT(near, 100);
}

}  // namespace aerate
