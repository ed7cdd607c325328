#pragma once

#include <span>

#include "core/mesh.h"

namespace aerate {

// Joins corners whose coordinates are equal (-0 equals 0). `corners`: 3 m positions, three for each triangle.
// Vertices are numbered in order of first use. O(m) expected.
Mesh weld(std::span<const Vec3f> corners);

}  // namespace aerate
