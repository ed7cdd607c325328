#pragma once

#include <optional>

#include "core/mesh.h"

namespace aerate {

// How far inside the footprint a model's centre of mass is, seen along z: the distance in mm to the nearest
// edge of the convex hull of what stands on the ground, negative outside of it. Nothing if it stands on no
// area (on a tip or an edge).
//   mesh: the outer surface; what is no higher than a hundredth of its height above its lowest point stands
//   on the ground
std::optional<double> footing_margin(const Mesh& mesh, Vec3d centre_of_mass);

}  // namespace aerate
