#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/cells.h"
#include "printing/cells/cell_region.h"
#include "printing/cells/shared_work.h"

namespace aerate {

// A box of a lattice's nodes; those along x run fastest.
struct NodeBox {
  NodeLattice lattice;
  std::int32_t x = 0, y = 0, z = 0;  // of its first node
  std::int32_t count_x = 0, count_y = 0, count_z = 0;

  std::size_t size() const {
    return static_cast<std::size_t>(count_x) * static_cast<std::size_t>(count_y) *
           static_cast<std::size_t>(count_z);
  }
  std::size_t step_y() const { return static_cast<std::size_t>(count_x); }
  std::size_t step_z() const { return static_cast<std::size_t>(count_x) * static_cast<std::size_t>(count_y); }
  std::size_t index(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return static_cast<std::size_t>(k) * step_z() + static_cast<std::size_t>(j) * step_y() +
           static_cast<std::size_t>(i);
  }
  Vec3d at(double i, double j, double k) const {
    return lattice.origin + Vec3d{x + i, y + j, z + k} * lattice.spacing;
  }
};

// The corners of a cube of nodes, by the bits of their numbers: 1 along x, 2 along y, 4 along z.
inline std::array<std::size_t, 8> cube_at(const NodeBox& box, std::int32_t i, std::int32_t j,
                                          std::int32_t k) {
  const std::size_t first = box.index(i, j, k), y = box.step_y(), z = box.step_z();
  return {first,     first + 1,     first + y,     first + y + 1,
          first + z, first + z + 1, first + z + y, first + z + y + 1};
}

// What is known of the nodes about one cell's region. Nodes that a ball of the radius that was asked for does
// not fit round have depth -1.
struct CellNodes {
  NodeBox box;
  double ball_radius = 0;
  double deepest = 0;                // depths are known up to this: beyond, they are only that much
  std::vector<float> depth;          // in the region
  std::vector<float> surface_depth;  // below the wall, where the node has a depth; large if not near
  std::vector<std::uint32_t> facet;  // nearest, where the surface is near, or kNone

  bool has_ball(std::size_t node) const { return depth[node] >= 0; }
  // Of those whose ball reaches beyond all that a deeper one covers.
  bool is_outermost(std::size_t node) const {
    return depth[node] >= 0 && depth[node] < static_cast<float>(deepest);
  }
};

// Nodes that one cell may have: about 2 GB.
inline constexpr std::size_t kMostNodesOfCell = std::size_t{1} << 26;

// Looks at the nodes of a lattice in `within`, which holds the cell. Blocks of nodes are told from their middles
// where the region's depth allows it, so that the time goes with the region's surface. The box that is returned
// has two nodes without a ball on each side, and room for balls. Throws std::length_error if there are more than
// kMostNodesOfCell.
CellNodes look_at_nodes(const CellRegion& region, const Box3d& within, double ball_radius,
                        const NodeLattice& lattice, SharedWork& work);

// The square of the distance in spacings from each node to the nearest node of a set; kFarAway where the way is longer
// than `most` along some axis. One axis after the other (P. Felzenszwalb and D. Huttenlocher, "Distance Transforms of
// Sampled Functions", 2012), O(most) for each node.
inline constexpr std::int32_t kFarAway = std::int32_t{1} << 29;
std::vector<std::int32_t> squared_distances(const NodeBox& box,
                                            const std::function<bool(std::size_t node)>& is_in_set,
                                            std::int32_t most);

}  // namespace aerate
