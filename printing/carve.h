#pragma once

#include <cstddef>
#include <optional>

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/solid.h"

namespace aerate {

struct CarveOptions {
  // Void surfaces deviate from the planned shapes by at most this, and inwards only: a void is never larger
  // than planned. Millimetres, > 0.
  double tolerance = 0.05;
};

// The outer surface as it is, and the void surfaces of a packing: inward-oriented, one closed shell for each
// sphere, in its order. Each comes from an OpenVDB level set whose voxels suit its radius and the
// tolerance; its vertices are projected onto the planned sphere, spread evenly over it, and rounded towards
// its inside. A void keeps at least 90 % of its volume however coarse the tolerance is. The bytes depend on
// the arguments alone. Throws UsageError if fp32 cannot hold a void so exactly where it is, FailureError if a void
// took more than about a million triangles; InterruptedError.
Solid carve_keeping_surface(Mesh outer, const Packing& packing, const CarveOptions& options,
                            Monitor& monitor);

// A bound of the number of triangles that `carve_keeping_surface` will make for the voids alone, by a
// formula.
double most_void_triangles(const Packing& packing, const CarveOptions& options);

// That number. Takes nearly all of the time that making them takes. Throws as `carve_keeping_surface` does.
std::size_t estimate_void_triangles(const Packing& packing, const CarveOptions& options);

// The finest tolerance, not below that of `options` and within 1 %, at which the voids take at most
// `max_triangles`; nullopt if they take more even at their coarsest.
std::optional<double> loosen_tolerance(const Packing& packing, const CarveOptions& options,
                                       std::size_t max_triangles);

}  // namespace aerate
