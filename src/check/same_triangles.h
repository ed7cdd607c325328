#pragma once

#include <cstddef>

#include "core/mesh.h"
#include "core/monitor.h"

namespace aerate {

// Whether triangle `i` of one mesh has the corners of triangle `j` of another, coordinate for coordinate: the
// vertices may be numbered differently.
bool has_same_corners(const Mesh& a, std::size_t i, const Mesh& b, std::size_t j);

// The first of `count` triangles that differs between two meshes; `count` if none does. On all threads.
// Throws InterruptedError.
std::size_t find_difference(const Mesh& a, const Mesh& b, std::size_t count, Monitor& monitor);

// Throws FailureError unless the triangles of a mesh that was read back are those of `written`;
// InterruptedError. On all threads.
void require_same_triangles(const Mesh& read_back, const Mesh& written, Monitor& monitor);

}  // namespace aerate
