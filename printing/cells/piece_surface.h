#pragma once

#include <cstdint>
#include <vector>

#include "core/cells.h"
#include "printing/cells/rolled_balls.h"
#include "printing/cells/surface_placer.h"

namespace aerate {

// The surface of a piece of an opened cell.
struct PieceSurface {
  std::vector<PlacedVertex> vertices;
  std::vector<Triangle> triangles;  // facing into the void
  std::int64_t euler = 0;           // Euler characteristic, counted on the nodes: not on the triangles
};

// A vertex for each cube of nodes that the surface passes (S. Gibson, "Constrained elastic surface nets", 1998),
// placed on the opened region's surface. Since the piece is well-composed the result is a closed 2-manifold.
PieceSurface surface_of_piece(const NodeBox& box, const OpenedCell& opened, const CellNodes& nodes,
                              const std::vector<std::int32_t>& labels, std::int32_t piece,
                              const SurfacePlacer& placer, SharedWork& work);

// The nodes of a piece as runs.
std::vector<NodeRun> runs_of_piece(const NodeBox& box, const std::vector<std::int32_t>& labels,
                                   std::int32_t piece);

}  // namespace aerate
