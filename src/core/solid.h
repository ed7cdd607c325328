#pragma once

#include <cstddef>
#include <vector>

#include "core/mesh.h"

namespace aerate {

// Consecutive triangles and vertices of a mesh that form one closed shell.
struct ShellRange {
  std::size_t first_triangle = 0;
  std::size_t triangle_count = 0;
  std::size_t first_vertex = 0;
  std::size_t vertex_count = 0;
};

// A model with voids, ready to write: one mesh that holds the outer surface first (oriented outward, triangle
// for triangle as given in `keep` mode) and then the void shells (oriented inward, so that their signed
// volume is negative), one after another.
struct Solid {
  Mesh mesh;
  std::size_t outer_triangle_count = 0;
  std::size_t outer_vertex_count = 0;
  std::vector<ShellRange> void_shells;  // void_shells[i] is the surface of void i of the plan
};

}  // namespace aerate
