#pragma once

#include "check/output_facts.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/solid.h"
#include "core/surface_index.h"
#include "core/void_plan.h"
#include "mesh/inspect.h"

namespace aerate {

// What a written file is held against.
struct ExpectedOutput {
  const Solid& solid;            // what was written
  const Mesh& model;             // what was packed
  const SurfaceIndex& surface;   // of `model`
  const Inspection& inspection;  // of `model`: flaws that the output may keep
  const VoidPlan& plan;
  const PackingLimits& limits;
  double tolerance = 0;  // mm
  OuterSurface outer = OuterSurface::kept;
};

// Checks and measures a mesh that was read back from disk, its vertices welded and numbered in order of first
// use:
//   - every triangle is the one that was written, coordinate for coordinate; if the surface was kept, the
//     first ones are the model's;
//   - the outer part is closed, without misoriented edges, with no more non-manifold edges than the model;
//   - each void is a shell of its own as planned (check_voids.h);
//   - the balls round the voids, with their roofs, keep the wall and the gap, where the winding number of the
//     outer part is 1;
//   - the ceilings of the voids, where they are limited, are no wider than the bridge and one tolerance;
//   - the volumes add up.
// On all threads; the facts are the same for any number of them. Throws FailureError that says which of these
// does not hold; InterruptedError.
OutputFacts check_output(const Mesh& read_back, const ExpectedOutput& expected, Monitor& monitor);

}  // namespace aerate
