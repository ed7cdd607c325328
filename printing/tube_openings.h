#pragma once

#include <cstddef>

#include "core/drainage.h"
#include "kernels/roof.h"
#include "kernels/sphere.h"
#include "printing/open_ball.h"

// Voids and tubes as they are meshed: smaller than planned by what fp32 may round them outwards.

namespace aerate {

Sphere shrunk(const Roof& roof, const Sphere& ball);
Tube shrunk(const Tube& tube);

// Sides of the prism that stands for a tube: fine enough for openings that it meets obliquely, whose edges
// are up to 2.5 times as long as its own.
std::size_t sides_of(const Tube& tube, double tolerance);

// Where a tube of so many sides opens into a ball.
Opening opening_of(const Tube& tube, TubeEnd end, const Sphere& ball, const Roof& roof, std::size_t sides);

}  // namespace aerate
