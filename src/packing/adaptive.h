#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "core/device.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"

namespace aerate {

struct AdaptiveOptions {
  // Packing stops when there are this many spheres...
  std::size_t max_count = std::numeric_limits<std::size_t>::max();
  // ...or when they fill this share of the model's volume, in (0, 1)...
  double target_density = 1.0;
  // ...which is this, mm3, for a model whose shells overlap; else what its surface bounds.
  std::optional<double> volume = std::nullopt;
};

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
Packing pack_adaptive(const Mesh& mesh, const PackingLimits& limits, const AdaptiveOptions& options,
                      Monitor& monitor, const DeviceRequest& device = {});

// Bytes that `pack_adaptive` is going to need, about: for a refusal before work starts.
double estimate_adaptive_bytes(const Mesh& mesh, const PackingLimits& limits, const AdaptiveOptions& options);

}  // namespace aerate
