#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "core/mesh.h"

namespace aerate::test {

// The bytes of a binary STL file with the facets of `mesh` (normals are left zero).
inline std::string to_binary_stl(const Mesh& mesh, std::string_view header = "") {
  std::string bytes(80, '\0');
  bytes.replace(0, header.size(), header);
  const auto append = [&](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  append(&count, sizeof(count));
  for (const Triangle& triangle : mesh.triangles) {
    bytes.append(12, '\0');
    for (const std::uint32_t vertex : triangle) append(&mesh.positions[vertex], sizeof(Vec3f));
    bytes.append(2, '\0');
  }
  return bytes;
}

}  // namespace aerate::test
