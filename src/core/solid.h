#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/mesh.h"

namespace aerate {

// What a part of a solid's surface bounds.
enum class PartKind {
  outer,         // the model outside: its triangles in their order, but for those that holes cut
  remnant,       // what holes leave of these
  void_surface,  // one void
  channel,       // one channel between two voids
  hole,          // one way out of a void
};

// Consecutive triangles of a mesh.
struct SolidPart {
  PartKind kind = PartKind::outer;
  std::size_t first_triangle = 0;
  std::size_t triangle_count = 0;

  std::size_t end() const { return first_triangle + triangle_count; }
};

// A model with voids, ready to write. Its parts follow each other from the mesh's first triangle to the last,
// by kind, and of a kind in the order of the plan. What is outside faces outward; voids, channels and holes
// face into what they bound, so that the signed volume of a sealed void is negative.
struct Solid {
  Mesh mesh;
  std::vector<SolidPart> parts;

  // Adds the mesh's triangles after the last part as one more.
  void close_part(PartKind kind);

  std::span<const SolidPart> of(PartKind kind) const;
  // Triangles of the outer surface, remnants included: those of voids and tubes come after them.
  std::size_t outer_triangle_count() const;
};

// The triangles of a part, of the solid's own mesh or of one that was read back.
std::span<const Triangle> triangles_of(const Mesh& mesh, const SolidPart& part);

}  // namespace aerate
