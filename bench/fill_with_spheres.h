#pragma once

#include <cstddef>
#include <vector>

#include "core/mesh.h"
#include "kernels/sphere.h"

namespace aerate::bench {

// OpenVDB's own sphere packer, for comparison: the model as a level set of `voxel` mm, then
// `tools::fillWithSpheres` for at most `count` spheres that do not overlap.
std::vector<Sphere> fill_with_spheres(const Mesh& mesh, std::size_t count, double voxel);

}  // namespace aerate::bench
