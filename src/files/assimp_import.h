#pragma once

#include <cstddef>
#include <optional>

#include "files/input_file.h"
#include "files/part_writer.h"

namespace aerate {

// What no sane file exceeds. Nodes show meshes again and again, so that a few bytes can become endlessly many
// triangles.
inline constexpr std::size_t kMostBytes = std::size_t{1} << 31;
inline constexpr int kMaxNodeDepth = 256;
inline constexpr std::size_t kMostInstancedTriangles = std::size_t{1} << 25;

// Reads a file through assimp, which is lenient: it reads past missing data with zeros, leaves out what it
// cannot use and trusts the counts of a header with memory. So the room of a format looks through the whole
// file before, and says how many faces (of any number of corners) it promises. `extension` is lower case
// without its dot; `factor` converts a coordinate to millimetres. Throws InputError for what assimp refuses,
// for coordinates that are not finite, and where faces are missing. Nodes are taken with their transforms,
// under `placement`; one that shows a mesh is a part. No other file is ever opened.
LoadedModel import_with_assimp(const InputFile& file, const char* extension,
                               std::optional<std::size_t> promised_faces, double factor,
                               const Affine& placement = Affine::Identity());

}  // namespace aerate
