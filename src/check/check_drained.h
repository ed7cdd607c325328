#pragma once

#include <cstddef>

#include "check/expected.h"
#include "core/mesh.h"
#include "core/monitor.h"

namespace aerate {

// Checks how a mesh that was read back, its vertices welded, hangs together if its voids drain:
//   - it is closed, without misoriented edges, with no more non-manifold edges than the model, and its Euler
//     characteristic is that of the model with these voids, channels and holes, no more and no fewer;
//   - no inner surface is a shell of its own, and every hole opens to the outside of all shells: no cavity is
//     sealed that the model did not have;
//   - near escape holes no triangles intersect.
// Returns the number of sealed cavities, which is 0. On all threads. Throws FailureError for the first that
// is not so; InterruptedError.
std::size_t check_drained(const Mesh& read_back, const Expected& expected, Monitor& monitor);

}  // namespace aerate
