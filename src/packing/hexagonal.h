#pragma once

#include "packing/methods.h"

namespace aerate {

// Hexagonal (AB-stacked) layers with interstitial spheres and 61-sphere replacements after Cuba and Loaiza,
// as docs/packing.md states it: the lattice is built for `max_radius + gap/2`, each sphere's radius is then
// less by gap/2. Kept are spheres that are at least `wall` from the surface, at least `min_radius` large, and
// where the winding number is 1. The result does not depend on the device or the number of threads. It is
// meant to go through `verify_packing` before it is used.
//   mesh: closed (Inspection::closed)
// Throws FailureError if the job needs more than 2^32 places, or if the device that was asked for fails.
Packing pack_hexagonal(const Mesh& mesh, const PackingLimits& limits, Monitor& monitor,
                       const DeviceRequest& device = {});

PackingMethod hexagonal_method();

}  // namespace aerate
