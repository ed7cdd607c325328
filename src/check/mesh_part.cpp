#include "check/mesh_part.h"

#include <unordered_map>

namespace aerate {

Mesh part_of(const Mesh& mesh, std::span<const std::uint32_t> triangles) {
  Mesh part;
  std::unordered_map<std::uint32_t, std::uint32_t> number_of;
  for (const std::uint32_t index : triangles) {
    Triangle own{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = mesh.triangles[index][corner];
      const auto [place, is_new] =
          number_of.emplace(vertex, static_cast<std::uint32_t>(part.positions.size()));
      if (is_new) part.positions.push_back(mesh.positions[vertex]);
      own[corner] = place->second;
    }
    part.triangles.push_back(own);
  }
  return part;
}

}  // namespace aerate
