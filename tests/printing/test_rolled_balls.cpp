#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "core/surface_index.h"
#include "printing/cells/cell_nodes.h"
#include "printing/cells/piece_surface.h"
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

Mesh far_box() {
  return test::make_box({-200, -200, -200}, {200, 200, 200});
}

OpenedCell opened(const CellNodes& nodes, const Sphere& own = {{0, 0, 0}, 0.1, SphereKind::adaptive}) {
  const SurfaceIndex surface(far_box());
  const NearFacets near(surface.bvh());
  const CellRegion region({}, surface, near, 2);
  Monitor silent;
  SharedWork work(silent);
  return open_cell(region, nodes, own, work);
}

// Do those of the corners that are in a set, or out of it, hang together along edges?
bool hang_together(unsigned corners) {
  unsigned seen = corners & (~corners + 1);
  for (int round = 0; round < 8; ++round) {
    for (unsigned corner = 0; corner < 8; ++corner) {
      if ((corners >> corner & 1U) == 0) continue;
      for (const unsigned step : {1U, 2U, 4U})
        if ((seen >> (corner ^ step) & 1U) != 0) seen |= 1U << corner;
    }
  }
  return seen == corners;
}

bool has_diagonal_side(unsigned corners) {
  const std::array<std::array<unsigned, 4>, 6> sides{
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  return std::ranges::any_of(sides, [&](const std::array<unsigned, 4>& side) {
    const auto has = [&](std::size_t n) { return (corners >> side[n] & 1U) != 0; };
    return has(0) == has(2) && has(1) == has(3) && has(0) != has(1);
  });
}

// Nodes that all have balls.
void take_out_badly_composed(const NodeBox& box, std::vector<std::uint8_t>& is_void) {
  for (bool changes = true; changes;) {
    changes = false;
    for (std::int32_t k = 0; k + 1 < box.count_z; ++k) {
      for (std::int32_t j = 0; j + 1 < box.count_y; ++j) {
        for (std::int32_t i = 0; i + 1 < box.count_x; ++i) {
          const std::array<std::size_t, 8> corners = cube_at(box, i, j, k);
          unsigned set = 0;
          for (unsigned corner = 0; corner < 8; ++corner)
            set |= (is_void[corners[corner]] != 0 ? 1U : 0U) << corner;
          if (hang_together(set) && hang_together(~set & 255U) && !has_diagonal_side(set)) continue;
          for (const std::size_t node : corners) is_void[node] = 0;
          changes = true;
        }
      }
    }
  }
}

// The void's nodes of those that have a ball which holds no other node.
std::vector<std::size_t> void_of(const std::vector<std::array<std::int32_t, 3>>& places) {
  constexpr float kRadius = 0.2F;
  CellNodes nodes = solid_nodes(static_cast<double>(kRadius));
  for (const auto& [i, j, k] : places) nodes.depth[nodes.box.index(i, j, k)] = kRadius;
  const OpenedCell made = opened(nodes);
  std::vector<std::size_t> result;
  for (std::size_t node = 0; node < made.is_void.size(); ++node)
    if (made.is_void[node] != 0) result.push_back(node);
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

TEST(RolledBalls, AreWellComposedAsByLookingAtAllCubesAgainAndAgain) {
  std::mt19937 random(2);
  for (const unsigned share : {3U, 10U, 30U, 60U, 90U}) {
    constexpr float kRadius = 0.2F;
    CellNodes nodes = solid_nodes(static_cast<double>(kRadius));
    nodes.box.count_x = 41;
    nodes.box.count_y = 13;
    nodes.box.count_z = 11;
    nodes.depth.assign(nodes.box.size(), -1.F);
    nodes.surface_depth.assign(nodes.box.size(), 1e9F);
    nodes.facet.assign(nodes.box.size(), kNone);
    std::vector<std::uint8_t> expected(nodes.box.size(), 0);
    for (std::int32_t k = 2; k < 9; ++k) {
      for (std::int32_t j = 2; j < 11; ++j) {
        for (std::int32_t i = 2; i < 39; ++i) {
          if (random() % 100 >= share) continue;
          nodes.depth[nodes.box.index(i, j, k)] = kRadius;
          expected[nodes.box.index(i, j, k)] = 1;
        }
      }
    }
    take_out_badly_composed(nodes.box, expected);
    EXPECT_EQ(opened(nodes).is_void, expected) << share;
  }
}

// Two heaps of nodes with balls, one of them with less depth than it had.
TEST(CellNodes, InASmallerBoxAreOpenedAlike) {
  CellNodes nodes = solid_nodes(1.3);
  NodeBox& box = nodes.box;
  box.lattice = {.origin = {0.31, 0.37, 0.41}, .spacing = 0.7};
  box.x = -3;
  box.y = 17;
  box.z = 5;
  box.count_x = 70;
  box.count_y = 60;
  box.count_z = 50;
  nodes.deepest = 1.3 + 2 * 0.7;
  nodes.depth.assign(box.size(), -1.F);
  nodes.surface_depth.assign(box.size(), 1e9F);
  nodes.facet.assign(box.size(), kNone);
  const auto heap = [&](std::int32_t x, std::int32_t y, std::int32_t z, double radius) {
    for (std::int32_t k = 0; k < box.count_z; ++k) {
      for (std::int32_t j = 0; j < box.count_y; ++j) {
        for (std::int32_t i = 0; i < box.count_x; ++i) {
          const double depth = 1.3 + 0.7 * (radius - std::hypot(i - x, j - y, k - z));
          if (depth < 1.3) continue;
          nodes.depth[box.index(i, j, k)] = static_cast<float>(std::min(depth, nodes.deepest));
        }
      }
    }
  };
  heap(15, 20, 24, 4.3);
  heap(49, 40, 25, 6.1);
  std::vector<float> less = nodes.depth;
  for (std::size_t node = 0; node < box.size(); ++node)
    if (node % static_cast<std::size_t>(box.count_x) < 30) less[node] = -1;
  CellNodes whole = nodes;
  whole.depth = less;
  Monitor silent;
  SharedWork work(silent);
  const Sphere own{box.at(49, 40, 25), 3, SphereKind::adaptive};
  const CellNodes part = cut_to_balls(nodes, less, own, work);
  EXPECT_LT(part.box.size(), box.size() / 3);
  const OpenedCell of_whole = opened(whole, own), of_part = opened(part, own);
  const Vec3d moved{part.box.x - box.x + 0.0, part.box.y - box.y + 0.0, part.box.z - box.z + 0.0};
  std::size_t in_void = 0, elsewhere = 0;
  for (const std::uint8_t is_void : of_whole.is_void) elsewhere += is_void;
  for (std::int32_t k = 0; k < part.box.count_z; ++k) {
    for (std::int32_t j = 0; j < part.box.count_y; ++j) {
      for (std::int32_t i = 0; i < part.box.count_x; ++i) {
        const std::size_t here = part.box.index(i, j, k);
        const std::size_t there =
            box.index(i + static_cast<std::int32_t>(moved.x), j + static_cast<std::int32_t>(moved.y),
                      k + static_cast<std::int32_t>(moved.z));
        ASSERT_EQ(part.box.at(i, j, k), box.at(i + moved.x, j + moved.y, k + moved.z));
        ASSERT_EQ(of_part.is_void[here], of_whole.is_void[there]);
        ASSERT_EQ(of_part.cover[here], of_whole.cover[there]);
        in_void += of_part.is_void[here];
        if (of_part.ball[here] == kNone) continue;
        ASSERT_EQ(of_part.balls[of_part.ball[here]].centre, of_whole.balls[of_whole.ball[there]].centre);
      }
    }
  }
  EXPECT_EQ(in_void, elsewhere);
  EXPECT_GT(in_void, 500U);
  std::vector<std::int32_t> labels_of_whole, labels_of_part;
  const SurfaceIndex surface(far_box());
  const NearFacets near(surface.bvh());
  const CellRegion region({}, surface, near, 2);
  const SurfacePlacer placer(region, nodes.ball_radius, box.lattice.spacing, 1e-5);
  const auto pieces = find_pieces(box, of_whole.is_void, labels_of_whole);
  find_pieces(part.box, of_part.is_void, labels_of_part);
  const PieceSurface by_whole =
      surface_of_piece(box, of_whole, whole, labels_of_whole, pieces.front().label, placer, work);
  const PieceSurface by_part =
      surface_of_piece(part.box, of_part, part, labels_of_part, pieces.front().label, placer, work);
  EXPECT_EQ(by_part.triangles, by_whole.triangles);
  EXPECT_EQ(by_part.euler, by_whole.euler);
  ASSERT_EQ(by_part.vertices.size(), by_whole.vertices.size());
  for (std::size_t v = 0; v < by_part.vertices.size(); ++v)
    ASSERT_EQ(by_part.vertices[v].at, by_whole.vertices[v].at);
}

TEST(CellNodes, WithoutBallsAreNone) {
  const CellNodes nodes = solid_nodes(1);
  Monitor silent;
  SharedWork work(silent);
  EXPECT_EQ(cut_to_balls(nodes, nodes.depth, {{0, 0, 0}, 1, SphereKind::adaptive}, work).box.size(), 0U);
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
