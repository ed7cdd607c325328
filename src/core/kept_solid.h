#pragma once

#include <cstddef>

#include "core/mesh.h"
#include "core/surface_index.h"

namespace aerate {

// Regions of a model that stay solid: no void, channel or escape hole comes nearer to what of them lies in the
// model than the wall. Regions may overlap, and may reach out of the model, where they do not matter.
struct KeptSolid {
  std::size_t count = 0;  // of regions
  double volume = 0;      // of what they have in common with the model, mm3: measured along lines

  SurfaceIndex regions;  // all of them, each closed and outward: the winding number is not 0 in any of them
  SurfaceIndex within;   // what of their surfaces lies in the model: open where that ends

  // The model less the regions, as the packers see it: the model's triangles, and those of the regions turned
  // inward, so that the winding number is less by one in each. Where the model's own is 2, it is 1 in a region.
  Mesh room;
  SurfaceIndex room_surface;

  bool holds(Vec3d p) const { return regions.winding().winding_number(p) != 0; }
};

}  // namespace aerate
