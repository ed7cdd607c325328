#pragma once

#include <vector>

#include "core/mesh.h"

namespace aerate {

// The parts of a mesh that share no vertex, ordered by their first triangle; vertices and triangles keep
// their order. Vertices that no triangle uses are dropped.
std::vector<Mesh> split_into_shells(const Mesh& mesh);

// Number of those parts.
std::size_t count_shells(const Mesh& mesh);

}  // namespace aerate
