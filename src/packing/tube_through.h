#pragma once

#include <optional>

#include "core/drainage.h"
#include "core/void_shape.h"

// Tubes along given lines, cut to what is outside the balls of voids; nullopt where they do not meet these
// all round.

namespace aerate {

// From one void to another; the line leads through points inside both.
std::optional<Tube> tube_between(const VoidShape& from, const VoidShape& to, Vec3d inside_from,
                                 Vec3d inside_to, double radius);

// From a point outside a void along a direction (unit) that leads into it; nullopt also if it lies behind.
std::optional<Tube> tube_into(const VoidShape& to, Vec3d start, Vec3d direction, double radius);

// Out of a void, along a direction (unit) through a point inside it. Its end is `length` beyond its start.
std::optional<Tube> tube_out_of(const VoidShape& from, Vec3d inside, Vec3d direction, double length,
                                double radius);

}  // namespace aerate
