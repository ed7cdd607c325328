#pragma once

#include "check/expected.h"
#include "core/mesh.h"

namespace aerate {

// Checks the channels and holes of a mesh that was read back: each lies within its planned tube, faces its
// axis, opens into its voids below their roofs, keeps the gap from other voids and from tubes that lead to
// others, and channels keep the wall. Returns a lower bound of what is between channels and the surface, mm.
// Throws FailureError for the first that does not.
double check_tubes(const Mesh& read_back, const Expected& expected);

}  // namespace aerate
