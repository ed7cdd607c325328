#pragma once

#include <vector>

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/solid.h"
#include "core/void_plan.h"

namespace aerate {

// One void as it was written.
struct MeasuredVoid {
  Sphere ball;                  // round the planned centre; with the roof it takes, it holds every vertex
  double volume = 0;            // mm3
  double depth = 0;             // how far the surface stays inside the planned shape at most, mm
  Vec3d first_moment{0, 0, 0};  // volume integral of position, mm4
};

// Checks the void shells of a mesh that was read back, whose vertices are numbered in order of first use and
// whose triangles are those of `solid`: one after another to the last triangle, each of them closed,
// 2-manifold, a topological sphere, inward, with no vertex of another shell, and within [-tolerance, 0] of
// its planned shape (ball and roof), its volume too. In the order of the plan. O(triangles), on all threads.
// Throws FailureError for the first that is not so; InterruptedError.
std::vector<MeasuredVoid> check_voids(const Mesh& mesh, const Solid& solid, const VoidPlan& plan,
                                      double tolerance, Monitor& monitor);

}  // namespace aerate
