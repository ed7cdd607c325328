#pragma once

#include "kernels/annotations.h"
#include "kernels/vec.h"

namespace aerate::kernels {

struct Vec2d {
  double x, y;
};

// A triangle projected onto a plane of two axes, for entering it into cells. Separating axes of its edges
// only: the caller takes the cells from its bounding rectangle.
struct ProjectedTriangle {
  Vec2d a, b, c;

  // May say yes to a square that only nearly meets the triangle (by a millionth of its size), so that the
  // rounding of cell coordinates loses none.
  AERATE_HD bool meets_square(double centre_x, double centre_y, double half) const {
    return !is_separated(a, b, c, centre_x, centre_y, half) &&
           !is_separated(b, c, a, centre_x, centre_y, half) &&
           !is_separated(c, a, b, centre_x, centre_y, half);
  }

 private:
  // By the normal of the edge p-q; r is the third corner.
  AERATE_HD static bool is_separated(Vec2d p, Vec2d q, Vec2d r, double centre_x, double centre_y,
                                     double half) {
    const double nx = p.y - q.y;
    const double ny = q.x - p.x;
    const double opposite = nx * (r.x - p.x) + ny * (r.y - p.y);
    const double centre = nx * (centre_x - p.x) + ny * (centre_y - p.y);
    const double reach = half * (1 + 1e-6) * ((nx < 0 ? -nx : nx) + (ny < 0 ? -ny : ny));
    return centre + reach < min_of(opposite, 0.0) || centre - reach > max_of(opposite, 0.0);
  }
};

}  // namespace aerate::kernels
