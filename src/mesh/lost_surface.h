#pragma once

#include "core/mesh.h"
#include "core/surface_index.h"

namespace aerate {

// What a surface that was made anew has lost of a model: places of the model's surface just beneath which the
// model is filled and the new one is not. What became solid beside the model, such as a crack, is not lost.
struct LostSurface {
  double farthest = 0;    // of such a place from the new surface, mm
  Vec3d place{0, 0, 0};   // where that is
  double area_share = 0;  // of the model's surface: what lies further off than `tolerated`
};

// Both closed. Looks at points spread evenly over the model's surface, one for each triangle at least, the
// same in every run. `tolerated` in mm, more than 0. O((m + n) log n).
LostSurface find_lost_surface(const Mesh& model, const SurfaceIndex& model_surface,
                              const SurfaceIndex& new_surface, double tolerated);

}  // namespace aerate
