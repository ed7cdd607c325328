#pragma once

#include "core/mesh.h"
#include "core/segment_distance.h"

namespace aerate {

// The triangles of a mesh that are nearer to a segment than `reach` mm, with vertices of their own; those
// that shared a vertex still do.
Mesh part_near(const Mesh& mesh, const Segment& segment, double reach);

}  // namespace aerate
