#pragma once

#include "check/output_facts.h"
#include "core/cells.h"
#include "core/drainage.h"
#include "core/kept_solid.h"
#include "core/mesh.h"
#include "core/packing.h"
#include "core/solid.h"
#include "core/surface_index.h"
#include "mesh/inspect.h"

namespace aerate {

// What a written file is held against.
struct Expected {
  const Solid& solid;            // what was written
  const Mesh& model;             // what was packed: closed, outward
  const SurfaceIndex& surface;   // of `model`
  const Inspection& inspection;  // of `model`: flaws that the output may keep
  const Packing& packing;        // the voids, and the limits that they obey
  const CellVoids* cells =
      nullptr;                   // what was made of their cells; null: the voids are the packing's own shapes
  const DrainagePlan* drainage;  // their channels and holes; null: each void is sealed
  double tolerance = 0;          // mm
  OuterSurface outer = OuterSurface::kept;
  const KeptSolid* kept = nullptr;  // regions that stay solid; null: there are none
};

}  // namespace aerate
