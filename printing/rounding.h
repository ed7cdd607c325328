#pragma once

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/error.h"
#include "kernels/sphere.h"

// What single precision, which mesh files hold, does to the surface of a void.

namespace aerate {

inline double largest_coordinate(const Sphere& ball) {
  const Vec3d c = ball.centre;
  return std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)}) + ball.radius;
}

// How far inside the ball its vertices are planned, so that none of them leaves it when its coordinates are
// rounded to fp32. The largest coordinate M of the ball rounds by at most 2^-24 M, so a vertex moves by at
// most sqrt(3) 2^-24 M < 2^-23 M; what is left covers the rounding of the fp64 arithmetic.
inline double rounding_margin(const Sphere& ball) {
  return std::ldexp(largest_coordinate(ball), -23);
}

// Throws UsageError unless fp32 can hold the ball's surface within `tolerance` mm where it is.
inline void check_resolvable(const Sphere& ball, double tolerance) {
  // fp32 has to resolve this many steps within the tolerance and within the radius.
  constexpr double kMarginsPerTolerance = 4;
  constexpr double kMarginsPerRadius = 256;
  const double margin = rounding_margin(ball);
  if (tolerance >= kMarginsPerTolerance * margin && ball.radius >= kMarginsPerRadius * margin) return;
  throw UsageError(
      fmt::format("a void of radius {:f} mm at coordinates up to {:f} mm cannot be kept within a "
                  "tolerance of {:f} mm: coordinates in a mesh file are single precision",
                  ball.radius, largest_coordinate(ball), tolerance),
      "move the model nearer to the origin, or raise --tolerance");
}

}  // namespace aerate
