#include "core/top_opening.h"

#include <cmath>

namespace aerate {
namespace {

// Above this share of the shoulder's width there would be hardly any cone.
constexpr double kWidestShare = 0.9;

// How far a tube's ends may be off the axis, mm.
constexpr double kOnAxis = 1e-6;

}  // namespace

bool has_top_for(double tube_radius, const Sphere& ball, const Roof& roof) {
  return roof.shapes(ball.radius) && tube_radius >= roof.flat_radius() &&
         tube_radius <= kWidestShare * ball.radius * roof.cosine;
}

double top_opening_height(double tube_radius, double ball_radius, const Roof& roof) {
  return (ball_radius - tube_radius * roof.cosine) / roof.sine;
}

bool comes_out_of_top(const Tube& tube, const Sphere& ball, const Roof& roof) {
  if (!has_top_for(tube.radius, ball, roof)) return false;
  const auto aside = [&](Vec3d p) {
    const Vec3d offset = p - ball.centre;
    return length(offset - roof.up * dot(offset, roof.up));
  };
  const double start = dot(tube.start - ball.centre, roof.up);
  return aside(tube.start) < kOnAxis && aside(tube.end) < kOnAxis &&
         dot(tube.end - tube.start, roof.up) > 0 &&
         std::abs(start - top_opening_height(tube.radius, ball.radius, roof)) < kOnAxis;
}

}  // namespace aerate
