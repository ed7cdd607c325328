#pragma once

#include "core/drainage.h"
#include "kernels/roof.h"
#include "kernels/sphere.h"

// Tubes that come straight out of the top of a void with a roof: the cone ends where it is as wide as the
// tube, which takes the place of the flat top. Any other tube opens below the roof.

namespace aerate {

// Can a tube of this radius come out of the void's top?
bool has_top_for(double tube_radius, const Sphere& ball, const Roof& roof);

// Height above the centre at which the cone is as wide as the tube.
double top_opening_height(double tube_radius, double ball_radius, const Roof& roof);

// Does the tube start there? It then runs along `roof.up` through the centre.
bool comes_out_of_top(const Tube& tube, const Sphere& ball, const Roof& roof);

}  // namespace aerate
