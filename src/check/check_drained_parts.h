#pragma once

#include <span>
#include <vector>

#include "core/drainage.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/solid.h"
#include "kernels/sphere.h"

namespace aerate {

// What was found of the voids of a drained model.
struct DrainedParts {
  std::vector<Sphere> balls;  // round the planned centres: the least void that holds all its own surface
  double depth = 0;           // how far that stays inside the planned shapes at most, mm
};

// Checks the inner surface of a mesh that was read back, part by part as `solid` has them:
//   - each void's part lies within [-tolerance, 0] of its planned shape and faces its centre,
//   - each channel's and hole's part lies within its planned tube and faces its axis,
//   - these open into voids with roofs below them.
// Throws FailureError for the first that does not; InterruptedError.
DrainedParts check_drained_parts(const Mesh& mesh, const DrainedSolid& solid, std::span<const Sphere> balls,
                                 const DrainagePlan& plan, double tolerance, Monitor& monitor);

// Checks that tubes keep the gap from voids that they do not lead to, and from each other; those that lead to
// the same void only have to be apart. Throws FailureError.
void check_tube_gaps(std::span<const Sphere> balls, const DrainagePlan& plan, double gap);

}  // namespace aerate
