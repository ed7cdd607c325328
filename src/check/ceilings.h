#pragma once

#include <cstddef>
#include <span>

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/solid.h"
#include "kernels/roof.h"

namespace aerate {

// A facet is part of a ceiling if it leans out by so much more than the overhang angle: the facets of a wall
// that leans by just that angle lean a little more and a little less.
inline constexpr double kCeilingMarginDegrees = 5;

// The ceilings of a mesh's voids: facets that join along edges and lean out of the vertical by at least the
// overhang angle and kCeilingMarginDegrees.
struct Ceilings {
  std::size_t count = 0;
  // Diameter of the largest disc that fits into one, projected along `roof.up`, to 0.001 mm.
  double widest = 0;  // mm
};

// Of parts that face into voids; no ceiling reaches from one into another. O(triangles log triangles), on all
// threads; the same for any number of them. Throws InterruptedError.
Ceilings measure_ceilings(const Mesh& mesh, std::span<const SolidPart> parts, const Roof& roof,
                          Monitor& monitor);

// Throws FailureError if a ceiling is wider than the bridge by more than `tolerance` mm.
void require_bridged(const Ceilings& ceilings, const Roof& roof, double tolerance);

}  // namespace aerate
