#pragma once

#include <filesystem>

#include "core/mesh.h"
#include "printing/write.h"

namespace aerate {

// A mesh that `write_mesh` wrote, read from its file: triangles in the order of the file, vertices welded and
// numbered in order of first use, coordinates to the last bit. STL and PLY are read as any model is. OBJ is
// read here, since assimp rounds decimal numbers by up to a unit in the last place. Throws InputError or
// FailureError for a file that is not as it was written.
Mesh read_back(const std::filesystem::path& path, MeshFormat format);

}  // namespace aerate
