#pragma once

#include <optional>

#include "core/drainage.h"

namespace aerate {

// The tube along the line from `inside_from` to `inside_to`, points inside two disjoint balls, cut to what is
// outside them; nullopt if it does not meet both all round.
std::optional<Tube> tube_between(const Sphere& from, const Sphere& to, Vec3d inside_from, Vec3d inside_to,
                                 double radius);

// The tube from a ball along a direction (unit) through a point inside it, from where it has left the ball.
// Its end is `length` beyond its start. nullopt if it does not meet the ball all round.
std::optional<Tube> tube_out_of(const Sphere& ball, Vec3d inside, Vec3d direction, double length,
                                double radius);

// Height along `up` above which liquid in the ball leaves it through the tube: the lowest point of their
// common opening.
double opening_floor(const Tube& tube, TubeEnd end, const Sphere& ball, Vec3d up);

// Height that liquid has to reach to pass from one ball to the other through the tube, in either direction.
double sill_of(const Tube& tube, const Sphere& from, const Sphere& to, Vec3d up);

}  // namespace aerate
