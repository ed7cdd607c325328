#pragma once

#include "check/expected.h"
#include "core/mesh.h"
#include "core/monitor.h"

namespace aerate {

// Checks that no triangle of a void, a channel or a hole of a mesh that was read back is in a region that stays solid,
// nor nearer to what of one is in the model than the wall, by exact distances between triangles. Returns the least
// distance, infinite if the regions have no surface in the model. On all threads. Throws FailureError;
// InterruptedError.
double check_kept(const Mesh& read_back, const Expected& expected, Monitor& monitor);

}  // namespace aerate
