#pragma once

#include <vector>

#include "check/expected.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "kernels/sphere.h"

namespace aerate {

// One void as it was written.
struct MeasuredVoid {
  Sphere ball;                  // round the planned centre; with the roof it takes, it holds every vertex
  double depth = 0;             // how far the surface stays inside the planned shape at most, mm
  bool faces_centre = true;     // every triangle does
  double volume = 0;            // seen from the centre, mm3: of a sealed void its own
  Vec3d first_moment{0, 0, 0};  // volume integral of position, mm4
};

// Checks the voids of a mesh that was read back: each lies within [-tolerance, 0] of its planned shape (ball
// and roof). A sealed one has a volume to match; every triangle of one that drains faces its centre. In the
// order of the plan. O(triangles), on all threads. Throws FailureError for the first that is not so;
// InterruptedError.
std::vector<MeasuredVoid> check_voids(const Mesh& read_back, const Expected& expected, Monitor& monitor);

}  // namespace aerate
