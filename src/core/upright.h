#pragma once

#include "core/mesh.h"
#include "kernels/vec.h"

namespace aerate {

// Axes of a right-handed frame whose z points up. For +z they are the model's own, so that what is level
// stays exactly level.
struct UprightFrame {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  // `up`: a unit vector
  explicit UprightFrame(Vec3d up);

  bool is_the_models_own() const { return z == Vec3d{0, 0, 1}; }
  Vec3d to_frame(Vec3d p) const { return {dot(p, x), dot(p, y), dot(p, z)}; }
};

// The mesh turned so that the frame's z is +z.
Mesh turned_upright(const Mesh& mesh, const UprightFrame& frame);

}  // namespace aerate
