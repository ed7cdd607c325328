#pragma once

#include <algorithm>
#include <cmath>

#include "files/formats.h"
#include "files/input_file.h"
#include "files/load.h"
#include "printing/slicers/slicers.h"
#include "tests/fuzz/fuzz_input.h"

namespace aerate::fuzz {

// What holds for every mesh that was read.
inline void require_sound(const Mesh& mesh) {
  std::size_t used = 0;  // vertices come in the order in which triangles use them first
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::size_t corner : triangle) {
      require(corner <= used && corner < mesh.positions.size(), "triangles use vertices that are there");
      if (corner == used) ++used;
    }
  }
  require(used == mesh.positions.size(), "every vertex is used");
  require(std::ranges::all_of(
              mesh.positions,
              [](const Vec3f& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }),
          "coordinates are finite");
}

// Reads bytes as a model of a format; `check(mesh)` says what else must hold for these bytes.
template <typename Check>
int read_model(const MeshFormat& format, std::string_view bytes, const Check& check) {
  if (bytes.empty()) return 0;
  return run([&] {
    LoadOptions options;
    options.volume_lists = volume_lists();
    const LoadedModel model =
        load_model(file_in_memory(std::string("model") + format.ending, bytes), format, options);
    require(!model.mesh.triangles.empty(), "a model has triangles");
    require_sound(model.mesh);
    check(model.mesh);
  });
}

}  // namespace aerate::fuzz
