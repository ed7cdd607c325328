#pragma once

#include "core/device.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"

namespace aerate {

// Bytes that `pack_hexagonal` is going to need at most (index, candidates, result), from the bounding box and
// the limits alone, so that a job can be refused before work starts.
double estimate_hexagonal_bytes(const Mesh& mesh, const PackingLimits& limits);

// Hexagonal (AB-stacked) layers with interstitial spheres and 61-sphere replacements after Cuba and Loaiza,
// as docs/packing.md states it: the lattice is built for `max_radius + gap/2`, each sphere's radius is then
// less by gap/2. Kept are spheres that are at least `wall` from the surface, at least `min_radius` large, and
// where the winding number is 1. The result does not depend on the device or the number of threads. It is
// meant to go through `verify_packing` before it is used.
//   mesh: closed (Inspection::closed)
// Throws FailureError if the job needs more than 2^32 places, or if the device that was asked for fails.
Packing pack_hexagonal(const Mesh& mesh, const PackingLimits& limits, Monitor& monitor,
                       const DeviceRequest& device = {});

}  // namespace aerate
