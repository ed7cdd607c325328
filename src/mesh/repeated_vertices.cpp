#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "core/listed.h"
#include "mesh/repair.h"
#include "mesh/topology.h"

namespace aerate {

Repaired without_repeated_vertices(Mesh mesh) {
  std::vector<Triangle> kept;
  kept.reserve(mesh.triangles.size());
  std::ranges::remove_copy_if(mesh.triangles, std::back_inserter(kept), has_repeated_vertex);
  const std::size_t left_out = mesh.triangles.size() - kept.size();
  if (left_out == 0 || kept.empty()) return {std::move(mesh), {}};
  return {submesh(mesh, kept),
          {fmt::format("{} with two equal corners {} left out; nothing is between them",
                       counted(left_out, "triangle", "triangles"), left_out == 1 ? "is" : "are")}};
}

}  // namespace aerate
