#pragma once

#include <cstddef>

#include "core/mesh.h"
#include "core/monitor.h"

namespace aerate {

// Whether triangle `i` of one mesh has the corners of triangle `j` of another, coordinate for coordinate: the
// vertices may be numbered differently.
bool has_same_corners(const Mesh& a, std::size_t i, const Mesh& b, std::size_t j);

// Throws FailureError unless the first triangles of a mesh that was read back are all those of `reference`,
// which is called `what` in the message; InterruptedError. On all threads.
void require_same_triangles(const Mesh& read_back, const Mesh& reference, const char* what, Monitor& monitor);

}  // namespace aerate
