#pragma once

#include <cstdint>
#include <span>

#include "core/cells.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/solid.h"
#include "core/surface_index.h"

namespace aerate {

struct CellShape {
  // Of the ball that voids are opened by, mm: what is narrower stays solid, and inner edges are rounded by it.
  double fillet = 1;
  // Void surfaces deviate from the planned shapes by about this, and inwards only. Millimetres.
  double tolerance = 0.05;
};

// A place in a cell.
struct CellPlace {
  std::uint32_t cell = 0;
  Vec3d at{0, 0, 0};
};

// Distance of the lattice's nodes that voids are shaped on, mm.
double node_spacing(const CellShape& shape, const PackingLimits& limits);

// Voids that fill the cells of a packing (`planes`, moved in by half the gap) as far as the model's surface leaves
// them the wall: each connected piece of each cell, opened by a ball. Pieces below 1 mm3, and those into which no
// ball of the least radius of the packing's limits fits, stay solid; pieces of one cell keep the gap from each
// other. Ceilings are not looked at.
//
// The void's surface is made on a lattice's nodes, each vertex moved to where the exact depth (fp64 distances to
// the triangles) says, and triangles that the tolerance does not need taken out (docs/cells.md). The same for any
// number of threads. O(volume / spacing^3). Throws UsageError for a fillet or a tolerance that lattice nodes cannot
// hold; InterruptedError.
CellVoids shape_cells(const SurfaceIndex& surface, const Packing& packing, CellPlanes planes,
                      const CellShape& shape, Monitor& monitor);

// The same voids, but those of the cells that `places` lie in are shaped anew, with a ball of solid material of a
// few node spacings about each place. Where a region is just as narrow as the ball that opens it, nodes may not tell
// what hangs together, and the surface may run through itself.
CellVoids shape_around(const SurfaceIndex& surface, const Packing& packing, CellVoids cells,
                       const CellShape& shape, std::span<const CellPlace> places, Monitor& monitor);

// The outer surface as it is, and the voids.
Solid carve_cells(Mesh outer, const CellVoids& cells);

}  // namespace aerate
