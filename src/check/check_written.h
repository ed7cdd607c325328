#pragma once

#include "check/expected.h"
#include "check/output_facts.h"
#include "core/mesh.h"
#include "core/monitor.h"

namespace aerate {

// Checks and measures a mesh that was read back from disk, its vertices welded and numbered in order of first
// use:
//   - every triangle is the one that was written, coordinate for coordinate, and the parts that were planned
//     follow each other from the first to the last;
//   - the first ones are the model's, less what escape holes cut (outer_surface.h);
//   - each void is where and as it was planned (check_voids.h), and so is each channel and hole
//     (check_tubes.h);
//   - it hangs together as it should: sealed voids as shells of their own (check_sealed.h), drained ones all
//     joined to the outside (check_drained.h);
//   - the balls round the voids, with their roofs, keep the wall and the gap;
//   - nothing is nearer than the wall to regions that stay solid, nor in them (check_kept.h);
//   - where ceilings are limited, none is wider than the bridge by more than the tolerance;
//   - the volumes add up.
// On all threads; the facts are the same for any number of them. Throws FailureError that says which of these
// does not hold; InterruptedError.
OutputFacts check_written(const Mesh& read_back, const Expected& expected, Monitor& monitor);

}  // namespace aerate
