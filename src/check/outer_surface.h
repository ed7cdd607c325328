#pragma once

#include <cstddef>

#include "check/expected.h"
#include "core/mesh.h"
#include "core/monitor.h"

namespace aerate {

// Checks the outer part of a mesh that was read back: its first triangles are the model's, in their order,
// less those that escape holes cut, each of which such a hole meets; what is left of these lies in the
// model's surface. Returns how many were cut. What inspection found out about the model then holds for the
// others. Throws FailureError; InterruptedError.
std::size_t check_outer_surface(const Mesh& read_back, const Expected& expected, Monitor& monitor);

}  // namespace aerate
