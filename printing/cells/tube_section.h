#pragma once

#include <cstddef>
#include <vector>

#include "core/drainage.h"
#include "kernels/roof.h"

namespace aerate {

// The cross-section of a tube as it is made: a convex polygon inscribed in its circle, about the tube's start,
// counter-clockwise seen against its axis.
//
// Where the printer does not bridge the tube's ceiling, this has a roof of its own: two sides that lean by just the
// overhang angle, and between them a top no wider than the bridge. A level tube of 5 mm is so left 98 % of its area
// where 2 mm are bridged and 45 degrees carry themselves.
//
//   sides: about so many
//   turn:  another value gives another polygon, with the same limits; 0 the largest
std::vector<Vec3d> tube_section(const Tube& tube, const Roof& roof, std::size_t sides, double turn);

}  // namespace aerate
