#pragma once

#include <optional>

#include "core/drainage.h"

namespace aerate {

// The tube along the line from `inside_from` to `inside_to`, points inside two disjoint balls, cut to what is
// outside them; nullopt if it does not meet both all round.
std::optional<Tube> tube_between(const Sphere& from, const Sphere& to, Vec3d inside_from, Vec3d inside_to,
                                 double radius);

// The tube from a point outside a ball along a direction (unit) that leads into it, cut to what is outside
// the ball. nullopt if it does not meet the ball all round, or meets it behind the point.
std::optional<Tube> tube_into(const Sphere& ball, Vec3d start, Vec3d direction, double radius);

// The tube from a ball along a direction (unit) through a point inside it, from where it has left the ball.
// Its end is `length` beyond its start. nullopt if it does not meet the ball all round.
std::optional<Tube> tube_out_of(const Sphere& ball, Vec3d inside, Vec3d direction, double length,
                                double radius);

// A tube that leaves a ball with a roof has to do so below it. `across` is the direction that rises most of
// those at right angles to the tube's, and `highest` the farthest along it, from the centre, that its axis
// may pass; infinite where nothing limits it. nullopt for a tube straight up, which has no such side.
struct WayBelowRoof {
  Vec3d across;
  double highest;
};
std::optional<WayBelowRoof> way_below_roof(const Sphere& ball, const Roof& roof, Vec3d direction,
                                           double radius);

// Height along `up` above which liquid in the ball leaves it through the tube: the lowest point of their
// common opening.
double opening_floor(const Tube& tube, TubeEnd end, const Sphere& ball, Vec3d up);

// Height that liquid has to reach to pass from one ball to the other through the tube, in either direction.
double sill_of(const Tube& tube, const Sphere& from, const Sphere& to, Vec3d up);

}  // namespace aerate
