#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "files/part_writer.h"

namespace aerate {

// What no sane file exceeds. Nodes show meshes again and again, so that a few bytes can become endlessly many
// triangles.
inline constexpr std::size_t kMostBytes = std::size_t{1} << 31;
inline constexpr int kMaxNodeDepth = 256;
inline constexpr std::size_t kMostInstancedTriangles = std::size_t{1} << 25;

// A file in the plainest form of a format: triangles and polygons, and what tells parts apart.
struct PlainFile {
  std::string bytes;
  std::size_t triangles = 0;              // that it promises, where a polygon of n corners counts n - 2
  std::vector<std::string> notices = {};  // see LoadedModel
};

// Reads through assimp, which is lenient: it reads past missing data with zeros, leaves out what it cannot use
// and trusts the counts of a header with memory. So the room of a format looks through the whole file before,
// and gives assimp a plain one that it makes of it. `name` is the file's, for messages; `extension` is lower
// case without its dot; `factor` converts coordinates to millimetres. Throws InputError for what assimp
// refuses, for coordinates that are not finite, and unless every triangle arrives. Nodes are taken with their
// transforms, under `placement`; one that shows a mesh is a part. No other file is ever opened.
LoadedModel import_with_assimp(const std::string& name, const PlainFile& file, const char* extension,
                               Vec3d factor, const Affine& placement = Affine::Identity());

}  // namespace aerate
