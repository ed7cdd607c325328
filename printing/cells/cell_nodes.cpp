#include "printing/cells/cell_nodes.h"

#include <algorithm>
#include <cmath>
#include <functional>
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

// The square of the way from each node of a row to the nearest one of the set; are there any?
bool measure_row(const std::uint8_t* is_in_set, std::int32_t* squared, std::size_t length,
                 std::int32_t most) {
  bool has_any = false;
  const auto sweep = [&](std::size_t i, std::int32_t& away) {
    away = is_in_set[i] != 0 ? 0 : away + 1;
    if (away > most) return;
    has_any = true;
    squared[i] = std::min(squared[i], away * away);
  };
  std::int32_t away = most;
  for (std::size_t i = 0; i < length; ++i) sweep(i, away);
  away = most;
  for (std::size_t i = length; i-- > 0;) sweep(i, away);
  return has_any;
}

}  // namespace

void NodeExtent::add(const NodeExtent& other) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = std::min(first[axis], other.first[axis]);
    last[axis] = std::max(last[axis], other.last[axis]);
  }
}

NodeExtent NodeExtent::grown(std::int32_t by, const NodeBox& box) const {
  const std::array<std::int32_t, 3> counts{box.count_x, box.count_y, box.count_z};
  NodeExtent result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.first[axis] = std::max(0, first[axis] - by);
    result.last[axis] = std::min(counts[axis] - 1, last[axis] + by);
  }
  return result;
}

std::optional<std::array<std::int32_t, 3>> NodeBox::nearest(Vec3d p) const {
  const Vec3d place = (p - origin()) * (1 / lattice.spacing);
  const auto i = static_cast<std::int32_t>(std::lround(place.x)) - cut_x;
  const auto j = static_cast<std::int32_t>(std::lround(place.y)) - cut_y;
  const auto k = static_cast<std::int32_t>(std::lround(place.z)) - cut_z;
  if (i < 0 || j < 0 || k < 0 || i >= count_x || j >= count_y || k >= count_z) return std::nullopt;
  return std::array{i, j, k};
}

NodeBox part_of(const NodeBox& box, const NodeExtent& extent) {
  const auto& [x, y, z] = extent.first;
  return {.lattice = box.lattice,
          .x = box.x + x,
          .y = box.y + y,
          .z = box.z + z,
          .count_x = extent.last[0] - x + 1,
          .count_y = extent.last[1] - y + 1,
          .count_z = extent.last[2] - z + 1,
          .cut_x = box.cut_x + x,
          .cut_y = box.cut_y + y,
          .cut_z = box.cut_z + z};
}

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

CellNodes cut_to_balls(const CellNodes& nodes, const std::vector<float>& depth, const Sphere& own,
                       SharedWork& work) {
  const NodeBox& box = nodes.box;
  CellNodes part;
  part.box.lattice = box.lattice;
  part.ball_radius = nodes.ball_radius;
  part.deepest = nodes.deepest;
  NodeExtent balls = extent_of(
      box, [&](std::size_t node) { return depth[node] >= 0; }, work);
  if (balls.is_empty()) return part;
  // How far a ball in an edge is from its node at most, and reaches, in spacings.
  constexpr double kBeyond = 8;
  const auto in_spacings = [&](double length) {
    return static_cast<std::int32_t>(std::ceil(length / box.lattice.spacing));
  };
  balls = balls.grown(in_spacings(nodes.deepest + kBeyond * box.lattice.spacing), box);
  if (const auto middle = box.nearest(own.centre)) {
    const auto [i, j, k] = *middle;
    const NodeExtent about{*middle, *middle};
    if (depth[box.index(i, j, k)] >= 0)
      balls.add(about.grown(in_spacings(own.radius + kBeyond * box.lattice.spacing), box));
  }
  part.box = part_of(box, balls);
  const auto copy = [&](const auto& from, auto& to) {
    to.reserve(part.box.size());
    for (std::int32_t k = balls.first[2]; k <= balls.last[2]; ++k) {
      for (std::int32_t j = balls.first[1]; j <= balls.last[1]; ++j) {
        const auto row = from.begin() + static_cast<std::ptrdiff_t>(box.index(balls.first[0], j, k));
        to.insert(to.end(), row, row + part.box.count_x);
      }
    }
  };
  const std::array<std::function<void()>, 3> copies{[&] { copy(depth, part.depth); },
                                                    [&] { copy(nodes.surface_depth, part.surface_depth); },
                                                    [&] { copy(nodes.facet, part.facet); }};
  work.for_each(copies.size(), 1, [&](std::size_t i) { copies[i](); });
  return part;
}

std::vector<std::int32_t> squared_distances(const NodeBox& box, const std::vector<std::uint8_t>& is_in_set,
                                            std::int32_t most, SharedWork& work) {
  std::vector<std::int32_t> squared(box.size(), kFarAway);
  const auto length = static_cast<std::size_t>(box.count_x);
  const std::int32_t rows = box.count_y, layers = box.count_z;
  std::vector<char> has_any(static_cast<std::size_t>(rows) * static_cast<std::size_t>(layers), 0);
  const auto row_at = [&](std::int32_t j, std::int32_t k) {
    return static_cast<std::size_t>(k) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(j);
  };
  constexpr std::size_t kGrain = 4;
  work.for_each(static_cast<std::size_t>(layers), kGrain, [&](std::size_t layer) {
    const auto k = static_cast<std::int32_t>(layer);
    for (std::int32_t j = 0; j < rows; ++j)
      has_any[row_at(j, k)] =
          measure_row(&is_in_set[box.index(0, j, k)], &squared[box.index(0, j, k)], length, most) ? 1 : 0;
  });
  // In each line of rows: the least of what others in it have and their own distance.
  std::vector<char> has_more = has_any;
  const auto along = [&](std::int32_t count, const auto& row_of, const auto& node_of) {
    std::vector<std::int32_t> before(static_cast<std::size_t>(count) * length);
    for (std::int32_t i = 0; i < count; ++i)
      if (has_any[row_of(i)] != 0)
        std::copy_n(&squared[node_of(i)], length, &before[static_cast<std::size_t>(i) * length]);
    for (std::int32_t i = 0; i < count; ++i) {
      std::int32_t* const row = &squared[node_of(i)];
      for (std::int32_t j = std::max(0, i - most); j <= std::min(count - 1, i + most); ++j) {
        if (j == i || has_any[row_of(j)] == 0) continue;
        const std::int32_t* const other = &before[static_cast<std::size_t>(j) * length];
        const std::int32_t apart = (i - j) * (i - j);
        for (std::size_t x = 0; x < length; ++x) row[x] = std::min(row[x], other[x] + apart);
        has_more[row_of(i)] = 1;
      }
    }
  };
  work.for_each(static_cast<std::size_t>(layers), kGrain, [&](std::size_t layer) {
    const auto k = static_cast<std::int32_t>(layer);
    along(
        rows, [&](std::int32_t j) { return row_at(j, k); },
        [&](std::int32_t j) { return box.index(0, j, k); });
  });
  has_any = has_more;
  work.for_each(static_cast<std::size_t>(rows), kGrain, [&](std::size_t row) {
    const auto j = static_cast<std::int32_t>(row);
    along(
        layers, [&](std::int32_t k) { return row_at(j, k); },
        [&](std::int32_t k) { return box.index(0, j, k); });
  });
  return squared;
}

}  // namespace aerate
