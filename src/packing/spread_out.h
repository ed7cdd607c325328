#pragma once

#include <span>
#include <vector>

#include "kernels/sphere.h"

namespace aerate {

// The spheres of a packing whose centres are at least `spacing` mm apart, chosen greedily, the largest first; in the
// order in which they came. So the cells of those that stay are about as large in a slender part of a model, where no
// large sphere fits, as they are elsewhere. O(n log n).
std::vector<Sphere> spread_out(std::span<const Sphere> spheres, double spacing);

}  // namespace aerate
