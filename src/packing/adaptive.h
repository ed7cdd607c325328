#pragma once

#include "packing/methods.h"

namespace aerate {

// Largest void first: again and again a sphere where the clearance to the surface (less `wall`) and to the
// spheres placed so far (less `gap`) is largest, down to `min_radius`. Where `max_radius` is small against
// the model, a lattice of spheres of that size comes first. docs/packing.md has the method, its figures and
// what they cost.
//
// Every sphere has at least `wall` and `gap` in fp64 (wall and gap are those of `limits`; max_radius may be
// infinite), lies where the winding number is 1, and is listed with those placed before it first. The result
// is the same to the bit on any device and for any number of threads. Voids that need roofs are packed with
// them.
//   mesh: closed (Inspection::closed)
// Throws UsageError for limits that contradict each other or would never end (no min_radius, count or
// density).
Packing pack_adaptive(const Mesh& mesh, const PackingLimits& limits, const PackingStop& stop,
                      Monitor& monitor, const DeviceRequest& device = {});

PackingMethod adaptive_method();

}  // namespace aerate
