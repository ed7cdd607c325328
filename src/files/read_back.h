#pragma once

#include <filesystem>

#include "core/mesh.h"
#include "core/monitor.h"
#include "files/write.h"

namespace aerate {

// A mesh that `write_mesh` wrote, read from its file: triangles in the order of the file, vertices welded and
// numbered in order of first use, coordinates to the last bit. Reads what our writers write and nothing else,
// a block at a time: assimp would hold several times the size of the file, and rounds decimals. 3MF is read
// as any model is: lib3mf gives the same bits. Throws FailureError (3MF: InputError) for a file that is not
// as it was written; InterruptedError.
Mesh read_back(const std::filesystem::path& path, MeshFormat format, Monitor& monitor);

}  // namespace aerate
