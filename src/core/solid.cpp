#include "core/solid.h"

#include <algorithm>

namespace aerate {

void Solid::close_part(PartKind kind) {
  const std::size_t first = parts.empty() ? 0 : parts.back().end();
  parts.push_back({kind, first, mesh.triangles.size() - first});
}

std::span<const SolidPart> Solid::of(PartKind kind) const {
  const auto found = std::equal_range(parts.begin(), parts.end(), SolidPart{kind},
                                      [](const SolidPart& a, const SolidPart& b) { return a.kind < b.kind; });
  return {found.first, found.second};
}

std::size_t Solid::outer_triangle_count() const {
  std::size_t count = 0;
  for (const PartKind kind : {PartKind::outer, PartKind::remnant})
    for (const SolidPart& part : of(kind)) count += part.triangle_count;
  return count;
}

std::span<const Triangle> triangles_of(const Mesh& mesh, const SolidPart& part) {
  return std::span(mesh.triangles).subspan(part.first_triangle, part.triangle_count);
}

}  // namespace aerate
