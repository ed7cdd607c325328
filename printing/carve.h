#pragma once

#include <cstddef>

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/solid.h"
#include "core/void_plan.h"

namespace aerate {

struct CarveOptions {
  // Void surfaces deviate from the planned shapes by at most this, and inwards only: a void is never larger
  // than planned. Millimetres.
  double tolerance = 0.05;
};

// The void surfaces of a plan, inward-oriented, one closed shell for each sphere, in the order of the plan.
// Each comes from an OpenVDB level set whose voxels suit its radius; its vertices are then projected onto the
// planned shape. Vertices are rounded towards the inside of the ball.
Solid carve_keeping_surface(Mesh outer, const VoidPlan& plan, const CarveOptions& options, Monitor& monitor);

// Number of triangles that `carve_keeping_surface` will make for the voids alone.
std::size_t estimate_void_triangles(const VoidPlan& plan, const CarveOptions& options);

}  // namespace aerate
