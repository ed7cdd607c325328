#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/constants.h"
#include "kernels/sphere.h"
#include "printing/cells/cell_nodes.h"
#include "printing/cells/cell_region.h"

namespace aerate {

// A ball that lies within a region.
struct RolledBall {
  Vec3d centre{0, 0, 0};
  double radius = 0;
  std::uint32_t facet = kNone;  // of the surface, near it, or kNone
  bool is_near_surface = false;
};

// A region opened by a ball: the union of all balls of its radius that fit into it, known on lattice nodes.
// Balls stand about the outermost nodes that have one, as large as the region allows there, and in the region's
// inner edges and corners, which pass between nodes.
struct OpenedCell {
  std::vector<RolledBall> balls;
  std::vector<float> cover;           // of nodes without a ball of their own: how deep they are in some ball
  std::vector<std::uint32_t> ball;    // in which; kNone
  std::vector<std::uint8_t> is_void;  // every node of the void
};

// `own`: the sphere that the cell belongs to; it lies in the region. No cube of nodes has two of its void's
// nodes, or two of the others, that only meet diagonally (the set is well-composed; L. Latecki, U. Eckhardt and
// A. Rosenfeld, "Well-composed sets", 1995), so that the surface between them is a 2-manifold.
OpenedCell open_cell(const CellRegion& region, const CellNodes& nodes, const Sphere& own, SharedWork& work);

// A set of void nodes that hang together, 6-connected.
struct NodePiece {
  std::int32_t label = 0;
  std::size_t size = 0;
};

// All pieces, the largest first; `labels` gets the piece of each node, or -1.
std::vector<NodePiece> find_pieces(const NodeBox& box, const std::vector<std::uint8_t>& is_void,
                                   std::vector<std::int32_t>& labels);

}  // namespace aerate
