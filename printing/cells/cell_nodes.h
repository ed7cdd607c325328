#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/cells.h"
#include "kernels/sphere.h"
#include "printing/cells/cell_region.h"
#include "printing/cells/shared_work.h"

namespace aerate {

// A box of a lattice's nodes; those along x run fastest.
struct NodeBox {
  NodeLattice lattice;
  std::int32_t x = 0, y = 0, z = 0;  // of its first node
  std::int32_t count_x = 0, count_y = 0, count_z = 0;
  // Of its first node in the box that it was cut out of: what is computed from there is the same to the last bit.
  std::int32_t cut_x = 0, cut_y = 0, cut_z = 0;

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
  // By places in the box that it was cut out of.
  Vec3d at_of_whole(double i, double j, double k) const {
    return lattice.origin + Vec3d{x - cut_x + i, y - cut_y + j, z - cut_z + k} * lattice.spacing;
  }
  Vec3d origin() const { return at_of_whole(0, 0, 0); }
  // The node nearest to a point, by its place along each axis, if that is in the box.
  std::optional<std::array<std::int32_t, 3>> nearest(Vec3d p) const;
};

// Nodes of a box, from the first to the last along each axis.
struct NodeExtent {
  std::array<std::int32_t, 3> first{std::numeric_limits<std::int32_t>::max(),
                                    std::numeric_limits<std::int32_t>::max(),
                                    std::numeric_limits<std::int32_t>::max()};
  std::array<std::int32_t, 3> last{-1, -1, -1};

  bool is_empty() const { return last[0] < first[0]; }
  void add(const NodeExtent& other);
  // By so many nodes on each side, as far as the box goes.
  NodeExtent grown(std::int32_t by, const NodeBox& box) const;
};

// Of the nodes of a box for which is_in(node).
template <typename IsIn>
NodeExtent extent_of(const NodeBox& box, const IsIn& is_in, SharedWork& work) {
  std::vector<NodeExtent> of_layer(static_cast<std::size_t>(box.count_z));
  work.for_each(of_layer.size(), 1, [&](std::size_t layer) {
    const auto k = static_cast<std::int32_t>(layer);
    for (std::int32_t j = 0; j < box.count_y; ++j) {
      const std::size_t row = box.index(0, j, k);
      std::int32_t first = 0, last = box.count_x - 1;
      while (first <= last && !is_in(row + static_cast<std::size_t>(first))) ++first;
      if (first > last) continue;
      while (!is_in(row + static_cast<std::size_t>(last))) --last;
      of_layer[layer].add({{first, j, k}, {last, j, k}});
    }
  });
  NodeExtent extent;
  for (const NodeExtent& own : of_layer) extent.add(own);
  return extent;
}

NodeBox part_of(const NodeBox& box, const NodeExtent& extent);

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

// The same nodes but for `depth`, which is less at some of them, in no larger a box than the balls may need that are still
// there: those of nodes, those in edges beside them (printing/cells/rolled_balls.h), and `own`, the cell's sphere. What is
// found out about these nodes is the same as in the larger box, but for how they are numbered.
CellNodes cut_to_balls(const CellNodes& nodes, const std::vector<float>& depth, const Sphere& own,
                       SharedWork& work);

// The square of the distance in spacings from each node to the nearest node of a set; kFarAway where the way is longer
// than `most` along some axis. One axis after the other (P. Felzenszwalb and D. Huttenlocher, "Distance Transforms of
// Sampled Functions", 2012), O(most) for each node. `is_in_set`: by node, 0 or 1.
inline constexpr std::int32_t kFarAway = std::int32_t{1} << 29;
std::vector<std::int32_t> squared_distances(const NodeBox& box, const std::vector<std::uint8_t>& is_in_set,
                                            std::int32_t most, SharedWork& work);

}  // namespace aerate
