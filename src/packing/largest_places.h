#pragma once

#include <vector>

#include "core/monitor.h"
#include "core/surface_index.h"
#include "packing/methods.h"

// Large places found without the packers' grids, from samples all over the model: for models in which these find none.
namespace aerate {

// The largest ball inside the model where its winding number is 1, touching the surface (no wall); radius 0
// if there is none. Accurate to about 1 %. Throws InterruptedError.
Sphere largest_inscribed_sphere(const SurfaceIndex& surface, Monitor& monitor);

// One after the other, each as large as the limits and those before it allow, until none of the least radius is found: at most 100, since each takes
// as long as some 10,000 distances. Without roofs: none of a radius that needs one. The same for any threads. Throws InterruptedError.
//   stop: with a volume, where its density is below 1
std::vector<Sphere> largest_places(const SurfaceIndex& surface, const PackingLimits& limits,
                                   const PackingStop& stop, Monitor& monitor);

}  // namespace aerate
