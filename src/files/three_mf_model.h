#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "files/part_writer.h"

namespace aerate {

// An object that a component or an item of the build stands for.
struct ObjectReference {
  std::string path;  // of its model part in the package; empty for the part that it is named in
  std::uint32_t id = 0;
  Affine transform = Affine::Identity();
  std::size_t line = 0;  // where it is named
};

struct ModelObject {
  std::uint32_t id = 0;
  std::string type = "model";  // or "support", "solidsupport", "surface", "other"
  Mesh mesh;                   // as the file has it, or:
  std::vector<ObjectReference> components;
};

// A model part of a 3MF package (docs/meshes.md): what of it makes the shape.
struct ModelPart {
  UnitOfFile unit{"millimeter", 1};
  std::map<std::uint32_t, ModelObject> objects;
  std::vector<ObjectReference> items;  // of the build, without those that are not to be printed
  std::size_t items_not_printed = 0;
};

// What to do with meshes of which Cura keeps in the model itself that they are no part of it.
enum class MeshesOfCura { refuse, take };

// Reads a model part whose bytes come in blocks: for_each_block calls what it is given with each. `where` is
// the file's name and the part's, for messages. Numbers are read whole, as the nearest fp32. Throws InputError
// with the line for XML that is not well-formed, numbers that are none, indices out of range, objects without
// shape or of no known type, beam lattices, infill meshes and the like of Cura unless these are taken, and extensions that the part requires and that are not honoured.
ModelPart read_model_part(
    const std::string& where,
    const std::function<void(const std::function<void(std::string_view)>& block)>& for_each_block,
    MeshesOfCura meshes = MeshesOfCura::refuse);

}  // namespace aerate
