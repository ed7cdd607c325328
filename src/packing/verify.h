#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/monitor.h"
#include "core/packing.h"
#include "core/surface_index.h"
#include "kernels/roof.h"

namespace aerate {

// Checks every sphere in fp64 against the surface (winding number 1 at the centre, wall) and against its
// neighbours (gap), by other means than the packers use: a bounding-volume hierarchy and a search among
// pairs. Shrinks what is too large by no more than rounding explains (1e-6 of the model's size), drops the
// rest and whatever became smaller than min_radius, and adds the counts to the statistics. Always run on a
// packing before it is used. Order is kept.
Packing verify_packing(const SurfaceIndex& surface, Packing packing);

// A sphere that breaks its packing's limits by more than rounding explains.
struct PackingFault {
  enum class Kind {
    outside,            // the winding number at its centre is 0
    overlapped_region,  // the winding number is neither 0 nor 1
    wall,               // too near to the surface
    gap,                // too near to another sphere
    too_small,          // smaller than min_radius
    too_large,          // larger than max_radius
  };
  Kind kind = Kind::outside;
  std::size_t sphere = 0;
  std::size_t other = 0;  // for `gap`: the other sphere, before this one
  double clearance = 0;   // for `wall` and `gap`: what there is, mm; negative for an overlap
};

// The first such sphere, by index.
std::optional<PackingFault> find_fault(const SurfaceIndex& surface, const Packing& packing);

// Smallest clearances of a set of balls, with the roofs that they take (a little less than the real ones
// above a roof, as kernels/roof_distance.h says), mm: to the surface (infinite without balls), and between
// two balls (nullopt for fewer than two). Negative where something overlaps.
struct Clearances {
  double wall = 0;
  std::optional<double> gap;
};
Clearances measure_clearances(const SurfaceIndex& surface, std::span<const Sphere> spheres,
                              const Roof& roof = {});

}  // namespace aerate
