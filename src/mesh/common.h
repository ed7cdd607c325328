#pragma once

#include <span>

#include "core/mesh.h"
#include "core/surface_index.h"

// What a mesh has in common with a model.

namespace aerate {

// What of a mesh's surface lies in a model, where its winding number is not 0: triangles of the mesh, and of those that
// the model's surface cuts pieces that reach no more than `precision` mm out of it.
Mesh surface_within(const Mesh& mesh, const SurfaceIndex& model, double precision);

// The volume, mm3, of what is in `body` and in `model`, and in none of `others` (closed meshes, in which their winding
// number is not 0), along 32,768 lines spread evenly over the body, the same in every run: good to about a hundredth.
double common_volume(const kernels::WindingView& body, const kernels::WindingView& model,
                     std::span<const kernels::WindingView> others);

}  // namespace aerate
