#pragma once

#include <span>

#include "check/drainage_facts.h"
#include "check/output_facts.h"
#include "core/drainage.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/solid.h"
#include "core/surface_index.h"
#include "mesh/inspect.h"
#include "printing/cut_holes.h"

namespace aerate {

// What a written file with drained voids is held against.
struct ExpectedDrained {
  const DrainedSolid& solid;     // what was written
  const Mesh& model;             // what was packed
  const SurfaceIndex& surface;   // of `model`
  const Inspection& inspection;  // of `model`: flaws that the output may keep
  std::span<const Sphere> balls;
  const DrainagePlan& plan;
  const PackingLimits& limits;
  double tolerance = 0;  // mm
};

// Whether the model, given with its index, runs through itself near a tube's outer end. A hole there could
// not be told from such a flaw.
bool is_crossed_near(const Mesh& model, const SurfaceIndex& surface, const Tube& tube);

// Whether the surface with its holes, and the sides of one of these, run through themselves where it comes
// out.
bool is_crossed_at(const OuterWithHoles& outer, std::size_t hole, const Tube& tube);

// Checks and measures a mesh that was read back from disk, its vertices welded:
//   - every triangle is the one that was written, coordinate for coordinate; the first ones are the model's,
//     in their order, less those that were cut, each of which an escape hole meets; what is left of these
//     lies in the model's surface;
//   - each void, channel and hole is where it was planned (check_drained_parts.h);
//   - wall and gap hold round the voids and the channels;
//   - it is closed, without misoriented edges, with no more non-manifold edges than the model, and its Euler
//     characteristic is that of the model with these voids, channels and holes, no more and no fewer;
//   - no inner surface is a shell of its own, and every hole opens to the outside of all shells: no cavity is
//     sealed that the model did not have;
//   - near escape holes no triangles intersect;
//   - where ceilings are limited, none of voids, channels and holes is wider than the bridge by more than the
//     tolerance;
//   - what was removed is at most what was planned, and at least the voids less the tolerance.
// Fills in what `drainage` says is measured. Throws FailureError that says which of these does not hold;
// InterruptedError.
OutputFacts check_drained(const Mesh& read_back, const ExpectedDrained& expected, DrainageFacts& drainage,
                          Monitor& monitor);

}  // namespace aerate
