#pragma once

#include <cstddef>
#include <cstdint>
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

// A model whose voids are joined to the outside, so that all of it is one surface. The mesh holds the outer
// triangles that were kept, in their order; what is left of those that escape holes cut; then for each void,
// each channel and each hole its part of the inner surface, facing into the void.
struct DrainedSolid {
  Mesh mesh;
  std::vector<std::uint32_t> cut_triangles;  // of the model, ascending: those that are not in the mesh
  std::size_t kept_triangle_count = 0;
  std::size_t outer_triangle_count = 0;                         // with what is left of the cut ones
  std::vector<std::size_t> void_ends, channel_ends, hole_ends;  // index after the last triangle of each
};

}  // namespace aerate
