#include "printing/cells/cell_nodes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace aerate {
namespace {

constexpr double kRootOf3 = 1.7320508075688772;

// Nodes along the side of the blocks that are looked at first.
constexpr std::int32_t kBlock = 16;

constexpr float kFar = 1e9F;

// What was found at the middle of a block, for the blocks in it.
struct Known {
  std::uint32_t facet = kNone;
  Vec3d middle{0, 0, 0};
  double distance = -1;    // of the surface from there: no part of it is nearer
  bool is_inside = false;  // there, and as far as `distance` reaches
  bool is_deep = false;    // the surface limits nothing in the block
};

class Filler {
 public:
  Filler(const CellRegion& region, CellNodes& nodes) : region_(region), nodes_(nodes) {}

  void fill(SharedWork& work) {
    const NodeBox& box = nodes_.box;
    const auto blocks = [](std::int32_t count) {
      return (static_cast<std::size_t>(count) + kBlock - 1) / kBlock;
    };
    const std::size_t x = blocks(box.count_x), y = blocks(box.count_y), z = blocks(box.count_z);
    const auto at = [](std::size_t block) { return static_cast<std::int32_t>(block) * kBlock; };
    constexpr std::size_t kGrain = 4;
    work.for_each(x * y * z, kGrain, [&](std::size_t block) {
      fill(at(block % x), at(block / x % y), at(block / (x * y)), kBlock, {});
    });
  }

 private:
  void fill(std::int32_t i, std::int32_t j, std::int32_t k, std::int32_t side, Known known) {
    const NodeBox& box = nodes_.box;
    if (i >= box.count_x || j >= box.count_y || k >= box.count_z) return;
    const double half = (side - 1) * 0.5;
    const Vec3d middle = box.at(i + half, j + half, k + half);
    const double reach = half * box.lattice.spacing * kRootOf3;
    const double behind = region_.behind_planes(middle);
    if (behind + reach < nodes_.ball_radius) return;
    // Placing vertices asks whether the surface is near some nodes beyond what limits the balls.
    const double most = nodes_.deepest + 1.5 * box.lattice.spacing;
    auto below = static_cast<double>(kFar);
    // What the block about this one tells of the surface may do for a node.
    const double at_least = known.distance - length(middle - known.middle) - region_.wall();
    if (side == 1 && known.is_inside && at_least >= std::min(behind, nodes_.deepest)) {
      if (behind >= nodes_.ball_radius)
        set(i, j, k, std::min(behind, nodes_.deepest), static_cast<float>(at_least), known.facet);
      return;
    }
    if (!known.is_deep) {
      const SurfaceNearby near = region_.surface_near(middle, region_.wall() + most + reach, known.facet);
      const bool is_told = length(middle - known.middle) < known.distance;
      const bool is_inside = is_told ? known.is_inside : region_.is_inside(middle);
      below = near.distance - region_.wall();
      if (is_inside ? below + reach < nodes_.ball_radius : near.distance >= reach || side == 1) return;
      known = {near.facet, middle, near.distance, is_inside, near.facet == kNone && is_inside};
    }
    if (side == 1) {
      const double depth = std::min(behind, below);
      if (depth < nodes_.ball_radius) return;
      set(i, j, k, std::min(depth, nodes_.deepest), known.is_deep ? kFar : static_cast<float>(below),
          known.facet);
      return;
    }
    if (known.is_deep && behind - reach >= nodes_.deepest) {
      for (std::int32_t z = k; z < std::min(k + side, box.count_z); ++z) {
        for (std::int32_t y = j; y < std::min(j + side, box.count_y); ++y) {
          for (std::int32_t x = i; x < std::min(i + side, box.count_x); ++x)
            set(x, y, z, nodes_.deepest, kFar, kNone);
        }
      }
      return;
    }
    const std::int32_t half_side = side / 2;
    for (std::int32_t part = 0; part < 8; ++part)
      fill(i + (part & 1) * half_side, j + (part >> 1 & 1) * half_side, k + (part >> 2) * half_side,
           half_side, known);
  }

  void set(std::int32_t i, std::int32_t j, std::int32_t k, double depth, float below, std::uint32_t facet) {
    const std::size_t node = nodes_.box.index(i, j, k);
    nodes_.depth[node] = static_cast<float>(depth);
    nodes_.surface_depth[node] = below;
    nodes_.facet[node] = facet;
  }

  const CellRegion& region_;
  CellNodes& nodes_;
};

// Of the points round which a ball fits: by blocks, so at least this.
std::optional<Box3d> box_of_balls(const CellRegion& region, const Box3d& within, double ball_radius,
                                  double side, SharedWork& work) {
  const double reach = side / 2 * kRootOf3;
  const Vec3d half{side / 2, side / 2, side / 2};
  Box3d box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  const Vec3d extent = within.upper - within.lower;
  const auto blocks = [side](double length) {
    return static_cast<std::int32_t>(std::ceil(length / side)) + 1;
  };
  // Looking at so many takes a minute, and what is found is too large.
  constexpr double kMostBlocks = 4e6;
  if (extent.x * extent.y * extent.z > kMostBlocks * side * side * side)
    throw std::length_error("a cell has too many blocks of lattice nodes");
  std::vector<Box3d> box_of_layer(static_cast<std::size_t>(blocks(extent.z)), box);
  work.for_each(box_of_layer.size(), 1, [&](std::size_t k) {
    Box3d& found = box_of_layer[k];
    for (std::int32_t j = 0; j < blocks(extent.y); ++j) {
      for (std::int32_t i = 0; i < blocks(extent.x); ++i) {
        const Vec3d middle = within.lower + half + Vec3d{side * i, side * j, side * static_cast<double>(k)};
        if (region.behind_planes(middle) + reach < ball_radius) continue;
        const double needed = region.wall() + ball_radius;
        const SurfaceNearby near = region.surface_near(middle, needed + reach, kNone);
        // Where the surface is not near, the middle tells for the block.
        if (near.distance >= reach) {
          if (!region.is_inside(middle) || near.distance + reach < needed) continue;
        }
        found = {min_of(found.lower, middle - half), max_of(found.upper, middle + half)};
      }
    }
  });
  for (const Box3d& found : box_of_layer)
    box = {min_of(box.lower, found.lower), max_of(box.upper, found.upper)};
  if (!(box.lower.x < box.upper.x)) return std::nullopt;
  return box;
}

}  // namespace

CellNodes look_at_nodes(const CellRegion& region, const Box3d& within, double ball_radius,
                        const NodeLattice& lattice, SharedWork& work) {
  constexpr double kBlocksPerCell = 6;
  const double spacing = lattice.spacing;
  CellNodes nodes;
  nodes.ball_radius = ball_radius;
  nodes.deepest = ball_radius + kRootOf3 * spacing;
  nodes.box.lattice = lattice;
  const auto balls = box_of_balls(region, within, ball_radius, kBlocksPerCell * spacing, work);
  if (!balls) return nodes;
  const double margin = nodes.deepest + 2 * spacing;
  const auto first = [&](double coordinate, double origin) {
    return static_cast<std::int32_t>(std::floor((coordinate - margin - origin) / spacing));
  };
  const auto count = [&](double coordinate, double origin, std::int32_t from) {
    return static_cast<std::int32_t>(std::ceil((coordinate + margin - origin) / spacing)) - from + 1;
  };
  NodeBox& box = nodes.box;
  box.x = first(balls->lower.x, lattice.origin.x);
  box.y = first(balls->lower.y, lattice.origin.y);
  box.z = first(balls->lower.z, lattice.origin.z);
  box.count_x = count(balls->upper.x, lattice.origin.x, box.x);
  box.count_y = count(balls->upper.y, lattice.origin.y, box.y);
  box.count_z = count(balls->upper.z, lattice.origin.z, box.z);
  if (box.size() > kMostNodesOfCell) throw std::length_error("a cell has more than 2^26 lattice nodes");
  nodes.depth.assign(box.size(), -1.F);
  nodes.surface_depth.assign(box.size(), kFar);
  nodes.facet.assign(box.size(), kNone);
  Filler(region, nodes).fill(work);
  return nodes;
}

std::vector<std::int32_t> squared_distances(const NodeBox& box,
                                            const std::function<bool(std::size_t node)>& is_in_set,
                                            std::int32_t most) {
  std::vector<std::int32_t> squared(box.size());
  for (std::size_t node = 0; node < box.size(); ++node) squared[node] = is_in_set(node) ? 0 : kFarAway;
  // In rows of `count` nodes that are `step` apart: the least of what others in it have and their own distance.
  std::vector<std::int32_t> row;
  const auto along = [&](std::size_t begin, std::size_t step, std::int32_t count) {
    row.clear();
    for (std::int32_t i = 0; i < count; ++i)
      row.push_back(squared[begin + static_cast<std::size_t>(i) * step]);
    if (std::ranges::min(row) == kFarAway) return;
    for (std::int32_t i = 0; i < count; ++i) {
      std::int32_t least = kFarAway;
      for (std::int32_t j = std::max(0, i - most); j <= std::min(count - 1, i + most); ++j)
        least = std::min(least, row[static_cast<std::size_t>(j)] + (i - j) * (i - j));
      squared[begin + static_cast<std::size_t>(i) * step] = least;
    }
  };
  for (std::int32_t k = 0; k < box.count_z; ++k)
    for (std::int32_t j = 0; j < box.count_y; ++j) along(box.index(0, j, k), 1, box.count_x);
  for (std::int32_t k = 0; k < box.count_z; ++k)
    for (std::int32_t i = 0; i < box.count_x; ++i) along(box.index(i, 0, k), box.step_y(), box.count_y);
  for (std::int32_t j = 0; j < box.count_y; ++j)
    for (std::int32_t i = 0; i < box.count_x; ++i) along(box.index(i, j, 0), box.step_z(), box.count_z);
  return squared;
}

}  // namespace aerate
