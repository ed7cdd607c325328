#pragma once

#include "core/mesh.h"

namespace aerate {

// Closed, outward meshes of simple bodies. None is smaller than its body: round ones lie about it, by no more than a
// two-hundredth of its radius, and what is rounded to fp32 is rounded outward.

// `lower` is less than `upper` along each axis.
Mesh box_mesh(Vec3d lower, Vec3d upper);

Mesh ball_mesh(Vec3d centre, double radius);

// About the axis from `start` to `end`, which differ.
Mesh cylinder_mesh(Vec3d start, Vec3d end, double radius);

}  // namespace aerate
