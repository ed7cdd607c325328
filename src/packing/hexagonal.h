#pragma once

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"

namespace aerate {

enum class CpuThreads { all, one };

// Bytes that `pack_hexagonal` is going to need at most: index, candidates and result. For a refusal before
// work starts.
double estimate_hexagonal_bytes(const Mesh& mesh, const PackingLimits& limits);

// Hexagonal (AB-stacked) layers with interstitial spheres and 61-sphere replacements after Cuba and Loaiza,
// as docs/packing.md states it: the lattice is built for `max_radius + gap/2`, each sphere's radius is then
// less by gap/2. Kept are spheres that are at least `wall` from the surface, at least `min_radius` large and
// where the winding number is 1; every sphere has been verified in fp64 (see verify.h). The result does not
// depend on the number of threads.
//   mesh: closed (Inspection::closed)
Packing pack_hexagonal(const Mesh& mesh, const PackingLimits& limits, Monitor& monitor,
                       CpuThreads threads = CpuThreads::all);

}  // namespace aerate
