#pragma once

#include <cmath>
#include <limits>

#include "kernels/annotations.h"
#include "kernels/vec.h"

// The shape of a void that prints without support, and how much room it needs.
//
// A printer bridges a ceiling up to some width, and prints walls that lean out by up to the overhang angle,
// measured from the vertical. The part of a ball's top that leans out further spans 2 r cos(overhang). Where
// that is wider than the bridge, the void is the ball, a cone that touches it and leans by the overhang
// angle, and a flat top where the cone's width has fallen to the bridge (docs/packing.md, "Roofs").
//
// Room is kept for a slightly larger shape, the convex hull of the ball and the smaller ball that just needs
// no roof: the union of balls at heights t in [0, spine] of radius r - t sin(overhang).
// kernels/roof_distance.h has the distances, which then follow from those of points of the spine.

namespace aerate {

struct Roof {
  Vec3d up{0, 0, 1};  // unit vector, against gravity
  // Of the overhang angle, in (0, 90) degrees from the vertical.
  double sine = 0.70710678118654757;
  double cosine = 0.70710678118654757;
  // Radius of the largest ball that needs no roof, mm: half the bridge over the cosine. Infinite: voids are
  // balls, whatever their size.
  double widest_ball = std::numeric_limits<double>::infinity();

  AERATE_HD bool shapes(double radius) const { return radius > widest_ball; }
  // Whether there is a rule at all.
  AERATE_HD bool limits_ceilings() const { return widest_ball < std::numeric_limits<double>::infinity(); }
  AERATE_HD double flat_radius() const { return widest_ball * cosine; }
  // Height above the centre at which the cone leaves the ball.
  AERATE_HD double shoulder(double radius) const { return radius * sine; }
  // Height of the topmost point above the centre.
  AERATE_HD double top(double radius) const {
    return shapes(radius) ? (radius - widest_ball * cosine * cosine) / sine : radius;
  }
  // Height of the smaller ball's centre above the larger one's.
  AERATE_HD double spine(double radius) const { return shapes(radius) ? (radius - widest_ball) / sine : 0.0; }
  AERATE_HD double bridge() const { return 2 * flat_radius(); }

  friend AERATE_HD bool operator==(const Roof& a, const Roof& b) {
    return a.up == b.up && a.sine == b.sine && a.cosine == b.cosine && a.widest_ball == b.widest_ball;
  }
};

// Volume of a void (of the shape itself, flat top), mm3.
inline double void_volume(const Roof& roof, double radius) {
  constexpr double kPi = 3.14159265358979324;
  if (!roof.shapes(radius)) return 4.0 / 3.0 * kPi * radius * radius * radius;
  const double shoulder = roof.shoulder(radius);
  const double below = kPi * (2.0 / 3.0 * radius * radius * radius + radius * radius * shoulder -
                              shoulder * shoulder * shoulder / 3);
  const double wide = radius * roof.cosine, narrow = roof.flat_radius();
  const double cone =
      kPi / 3 * (roof.top(radius) - shoulder) * (wide * wide + wide * narrow + narrow * narrow);
  return below + cone;
}

// Radius of the void round `centre` that `p` lies on: the least whose ball and cone, without end, hold p.
inline double lateral_radius(const Roof& roof, Vec3d centre, Vec3d p) {
  const Vec3d offset = p - centre;
  const double height = dot(offset, roof.up);
  const double aside = length(offset - roof.up * height);
  const bool beside_cone = height * roof.cosine > aside * roof.sine;
  if (!roof.limits_ceilings() || !beside_cone) return length(offset);
  return aside * roof.cosine + height * roof.sine;
}

// The same with the flat top: the least radius above `widest_ball` whose void round `centre` holds p.
inline double least_radius_holding(const Roof& roof, Vec3d centre, Vec3d p) {
  const double below_top =
      dot(p - centre, roof.up) * roof.sine + roof.widest_ball * roof.cosine * roof.cosine;
  return max_of(lateral_radius(roof, centre, p), below_top);
}

}  // namespace aerate
