#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/solid.h"
#include "kernels/roof.h"

namespace aerate {

// The ceilings (core/ceiling.h) of a mesh's voids.
struct Ceilings {
  std::size_t count = 0;
  // Diameter of the largest disc that fits into one, projected along `roof.up`, to 0.001 mm.
  double widest = 0;  // mm
};

// Of parts that face into voids; no ceiling reaches from one into another. O(triangles log triangles), on all
// threads; the same for any number of them. Throws InterruptedError.
Ceilings measure_ceilings(const Mesh& mesh, std::span<const SolidPart> parts, const Roof& roof,
                          Monitor& monitor);

// The same, each bridged, where there is a limit for ceilings; else nothing. Throws also what require_bridged throws.
std::optional<Ceilings> limited_ceilings(const Mesh& mesh, std::span<const SolidPart> parts, const Roof& roof,
                                         double tolerance, Monitor& monitor);

// Throws FailureError if a ceiling is wider than the bridge by more than `tolerance` mm.
void require_bridged(const Ceilings& ceilings, const Roof& roof, double tolerance);

}  // namespace aerate
