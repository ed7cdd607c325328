#pragma once

#include "check/expected.h"
#include "core/mesh.h"
#include "core/monitor.h"

namespace aerate {

// Checks how a mesh that was read back hangs together if each of its voids is sealed: vertices are numbered
// in order of first use, the outer surface is closed, without misoriented edges, with no more non-manifold
// edges than the model, and each void is a shell of its own: closed, 2-manifold, a topological sphere, with
// no vertex of another. On all threads. Throws FailureError for the first that is not so; InterruptedError.
void check_sealed(const Mesh& read_back, const Expected& expected, Monitor& monitor);

// A remeshed outer surface alone: closed and oriented, without new non-manifold edges. Throws FailureError.
void require_sound_outer(const Mesh& read_back, const Expected& expected);

}  // namespace aerate
