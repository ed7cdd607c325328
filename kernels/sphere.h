#pragma once

#include <cstdint>

#include "kernels/vec.h"

namespace aerate {

// Where a sphere of a packing comes from. The four radii are those of Cuba and Loaiza's hexagonal scheme.
enum class SphereKind : std::uint8_t {
  lattice,      // r_max: the hexagonal layers
  interstice,   // r_min: between three spheres of one layer, or in place of a `tetrahedral` that did not fit
  tetrahedral,  // r_med: the hole between three spheres of one layer and one of the next
  replacement,  // r_mid: one of the 61 in place of a `lattice` sphere that met the surface
  adaptive,     // placed where the clearance was largest
};

struct Sphere {
  Vec3d centre;
  double radius;
  SphereKind kind;
};

}  // namespace aerate
