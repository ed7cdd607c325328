#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "packing/cells/node_pools.h"

// How the hollows of a void grow out of its nodes.

namespace aerate {

// Heights are whole numbers, so many to a spacing: nodes of one layer are then level, and sorted in O(n).
inline constexpr std::int32_t kLevelsPerSpacing = 64;

// Heights of nodes above the lattice's origin, along a direction.
class NodeLevels {
 public:
  NodeLevels(const VoidNodes& nodes, Vec3d up);
  std::int32_t of(std::uint32_t node) const { return levels_[node]; }
  // The lowest first, then by number.
  std::span<const std::uint32_t> ascending() const { return ascending_; }

 private:
  std::vector<std::int32_t> levels_;
  std::vector<std::uint32_t> ascending_;
};

// The neighbours of nodes in other rows, by node; kNone if there is none.
struct NodeLinks {
  explicit NodeLinks(const VoidNodes& nodes);

  std::vector<std::uint32_t> before_y, after_y, before_z, after_z;
  std::vector<bool> begins;  // a run
};

// As Hollows, in levels along the orientation's up.
struct HollowForest {
  std::vector<std::uint32_t> parent;
  std::vector<std::int32_t> rim, bottom;
  std::vector<std::vector<std::uint32_t>> floor;  // nodes less than a spacing and a quarter above the bottom
  std::vector<std::uint32_t> of_node;
};

HollowForest grow_hollows(const VoidNodes& nodes, const NodeLinks& links, const NodeLevels& levels,
                          std::size_t orientation);

}  // namespace aerate
