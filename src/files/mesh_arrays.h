#pragma once

#include <string>

#include "core/mesh.h"
#include "files/load.h"

namespace aerate {

// The mesh of arrays, its coordinates multiplied by `factor` in double and rounded once; throws as load_model() of arrays does.
Mesh mesh_of_arrays(const MeshArrays& arrays, const std::string& name, Vec3d factor);

}  // namespace aerate
