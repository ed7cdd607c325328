#include "printing/tube_openings.h"

#include <algorithm>

#include "core/void_shape.h"
#include "printing/roof_top.h"
#include "printing/rounding.h"

namespace aerate {

Sphere shrunk(const Roof& roof, const Sphere& ball) {
  Sphere smaller = ball;
  smaller.radius -=
      roof.shapes(ball.radius) ? ball.radius * void_shrinkage(roof, ball) : rounding_margin(ball);
  return smaller;
}

Tube shrunk(const Tube& tube) {
  Tube smaller = tube;
  const Vec3d middle = (tube.start + tube.end) * 0.5;
  const double half = length(tube.end - tube.start) / 2;
  smaller.radius -= rounding_margin({middle, half + tube.radius, SphereKind::adaptive});
  return smaller;
}

std::size_t sides_of(const Tube& tube, double tolerance) {
  return tube_sides(tube.radius, tolerance / 8);
}

Opening opening_of(const Tube& tube, TubeEnd end, const Sphere& ball, const Roof& roof, std::size_t sides) {
  Opening opening{shrunk(tube), end, {}};
  opening.ring = VoidShape(shrunk(roof, ball), roof).rim(opening.tube, end, sides);
  // Counter-clockwise seen from outside the ball.
  if (end == TubeEnd::end) std::reverse(opening.ring.begin(), opening.ring.end());
  return opening;
}

}  // namespace aerate
