#pragma once

#include "core/mesh.h"

namespace aerate {

// Meshes of OpenVDB level sets, without OpenVDB's types.

// The smallest ball that a level set can hold, voxels: OpenVDB makes an empty one below that.
constexpr double kSmallestBallRadiusVoxels = 1.5;

// The zero set of a ball's level set, by dual contouring; everything in units of the voxel edge, with voxel
// centres at whole coordinates. Outward; quads are split anyhow. Closed, but the caller who relies on more
// checks it. Precondition: radius > kSmallestBallRadiusVoxels.
Mesh mesh_level_set_of_ball(Vec3d centre, double radius);

}  // namespace aerate
