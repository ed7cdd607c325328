#pragma once

#include "kernels/adaptive_field.h"
#include "kernels/vec.h"

// Local maxima of the clearance f: the centres of maximal balls, which touch four of surface and placed balls
// (the Apollonius point of the four).
//
// A cutting-plane search with four constraints at a time. Each constraint is a function |x - c| - r that
// equals f somewhere nearby. The four have unit normals n_k with the origin in their convex hull (weights w_k
// >= 0), so the point where all four are equal is the maximum of their minimum. There f is evaluated; if it
// is lower, what attains it enters, and the ratio test of the simplex method says which of the four leaves,
// so that the weights stay nonnegative. At first the four are a tetrahedron of artificial planes around the
// start.

namespace aerate::kernels {

struct LocalMaximum {
  Vec3d point;
  double value;  // f(point)
  double bound;  // no larger value is expected in the region searched
};

class FourConstraints {
 public:
  // Planes that are `value` at p and fall away from it at a slope of 1 on all sides.
  AERATE_HD void reset(Vec3d p, double value, double radius) {
    constexpr double kThird = 0.57735026918962576;
    reset_with_pull(p, {kThird, kThird, kThird}, value, value, radius);
  }

  // The same with a first plane that rises along `pull`, a unit vector along a diagonal of the axes, and is
  // `pull_value` at p.
  AERATE_HD void reset_with_pull(Vec3d p, Vec3d pull, double pull_value, double value, double radius) {
    // Gradient of |x - c| is away from c.
    centre_[0] = p - Vec3d{pull.x, pull.y, pull.z} * radius;
    centre_[1] = p - Vec3d{pull.x, -pull.y, -pull.z} * radius;
    centre_[2] = p - Vec3d{-pull.x, pull.y, -pull.z} * radius;
    centre_[3] = p - Vec3d{-pull.x, -pull.y, pull.z} * radius;
    AERATE_UNROLL
    for (int k = 0; k < 4; ++k) {
      radius_[k] = radius - (k == 0 ? pull_value : value);
      artificial_[k] = true;
    }
    move_to(p);
    solve();
  }
  AERATE_HD void raise_pull(double value) { radius_[0] -= value; }
  AERATE_HD double pull_weight() const { return -dot(cofactor_[0], normal_[3]); }
  AERATE_HD bool any_artificial_beside_pull() const {
    return artificial_[1] || artificial_[2] || artificial_[3];
  }
  // False where the pull would have to leave: no point nearby has the value that is wanted.
  AERATE_HD bool enter_beside_pull(const Clearance& constraint, Vec3d p) {
    enter(constraint, p);
    return artificial_[0];
  }

  // Normals, values and weights at p; false if the four normals lie in a plane.
  AERATE_HD bool linearise(Vec3d p) {
    move_to(p);
    return solve();
  }
  // Normals and values at p alone.
  AERATE_HD void move_to(Vec3d p) {
    AERATE_UNROLL
    for (int k = 0; k < 4; ++k) {
      const Vec3d away = p - centre_[k];
      const double distance = length(away);
      normal_[k] = away * (1.0 / distance);
      value_[k] = distance - radius_[k];
    }
  }
  // Weights of the normals that are known; false if these lie in a plane.
  AERATE_HD bool solve() {
    const Vec3d e0 = normal_[0] - normal_[3];
    const Vec3d e1 = normal_[1] - normal_[3];
    const Vec3d e2 = normal_[2] - normal_[3];
    const Vec3d c0 = cross(e1, e2);
    const double determinant = dot(e0, c0);
    if (!(determinant > kFlat || determinant < -kFlat)) return false;
    const double scale = 1.0 / determinant;
    cofactor_[0] = c0 * scale;
    cofactor_[1] = cross(e2, e0) * scale;
    cofactor_[2] = cross(e0, e1) * scale;
    return true;
  }

  // Step from the linearisation's point to where the four are equal.
  AERATE_HD Vec3d step() const {
    return cofactor_[0] * (value_[3] - value_[0]) + cofactor_[1] * (value_[3] - value_[1]) +
           cofactor_[2] * (value_[3] - value_[2]);
  }

  AERATE_HD double greatest() const {
    return max_of(max_of(value_[0], value_[1]), max_of(value_[2], value_[3]));
  }
  AERATE_HD bool any_artificial() const {
    return artificial_[0] || artificial_[1] || artificial_[2] || artificial_[3];
  }

  // Weights of the four normals that give a vector, summing to `sum`: 0 for differences, 1 for points.
  AERATE_HD double least_weight() const {
    double least = 1;
    double last = 1;
    AERATE_UNROLL
    for (int k = 0; k < 3; ++k) {
      const double w = -dot(cofactor_[k], normal_[3]);
      least = min_of(least, w);
      last -= w;
    }
    return min_of(least, last);
  }

  // Lets a constraint in, at the point p of the linearisation. The normals are those at p still; the weights
  // have to be solved for.
  AERATE_HD void enter(const Clearance& constraint, Vec3d p) {
    const Vec3d away = p - constraint.centre;
    const double distance = length(away);
    const Vec3d normal = away * (1.0 / distance);
    double weight[4], share[4];
    weight[3] = 1;
    share[3] = 1;
    AERATE_UNROLL
    for (int k = 0; k < 3; ++k) {
      weight[k] = -dot(cofactor_[k], normal_[3]);
      share[k] = dot(cofactor_[k], normal - normal_[3]);
      weight[3] -= weight[k];
      share[3] -= share[k];
    }
    int leaving = -1;
    double least_ratio = 0;
    AERATE_UNROLL
    for (int k = 0; k < 4; ++k) {
      if (share[k] <= 1e-9) continue;
      const double ratio = max_of(weight[k], 0.0) / share[k];
      if (leaving < 0 || ratio < least_ratio) {
        leaving = k;
        least_ratio = ratio;
      }
    }
    AERATE_UNROLL
    for (int k = 0; k < 4; ++k) {
      if (k == leaving) {
        centre_[k] = constraint.centre;
        radius_[k] = constraint.radius;
        normal_[k] = normal;
        value_[k] = distance - constraint.radius;
        artificial_[k] = false;
      }
    }
  }

 private:
  static constexpr double kFlat = 1e-7;

  Vec3d centre_[4];
  double radius_[4];
  bool artificial_[4];
  double value_[4];
  Vec3d normal_[4];
  Vec3d cofactor_[3];
};

struct RefineLimits {
  double least;      // maxima below this are of no use
  double most;       // f is clipped to this
  double tolerance;  // of the maximum, mm
  double region;     // how far the search goes, in extents of the cell
};

// Looks for a local maximum of f of at least `limits.least` within about `extent` of the anchor's point.
template <typename Shape>
AERATE_HD inline LocalMaximum find_local_maximum(const FieldView<Shape>& field, SurfaceAnchor anchor,
                                                 double extent, const RefineLimits& limits) {
  constexpr int kMostSteps = 48;
  constexpr int kMostRestarts = 2;
  // A region without a maximum of the least value is left at once where none is near to it. Else one step more
  // makes the bound tighter, for which the region will not be searched again as soon.
  constexpr double kNear = 0.93;
  constexpr int kMostStepsBelow = 1;
  Vec3d p = anchor.point;
  LocalMaximum best{p, -kInfinity, limits.most};
  Clearance here = clearance_at(field, anchor, p, limits.most, limits.most);
  if (here.value >= limits.most) {
    best.value = here.value;
    return best;
  }
  FourConstraints four;
  const double slack = max_of(limits.least + limits.region * extent, here.value + 0.5 * extent);
  four.reset(p, slack, 64 * slack);
  int restarts = 0, steps_below = 0;
  for (int step_count = 0; step_count < kMostSteps; ++step_count) {
    four.enter(here, p);
    // The same again, so that a device need not keep them in registers while it looks for what is nearest.
    if constexpr (!Shape::kIsBall) four.move_to(p);
    for (int k = 0; k < 2; ++k) {
      if (!four.solve()) return best;
      Vec3d step = four.step();
      const double walked = length(step);
      if (walked > 2 * extent) step = step * (2 * extent / walked);
      p = p + step;
      four.move_to(p);
      if (walked < 1e-3 * extent) break;
    }
    const double model = four.greatest();
    if (model < limits.least) {
      best.bound = max_of(model, best.value);
      if (model < kNear * limits.least || ++steps_below > kMostStepsBelow) return best;
    }
    if (!four.solve()) return best;
    // What is clipped has no constraint to enter, so it has to be enough.
    const double enough = min_of(model, limits.most) - limits.tolerance;
    here = clearance_at(field, anchor, p, limits.most, enough);
    if (here.value < enough) continue;
    if (here.value > best.value) {
      best.point = p;
      best.value = here.value;
      if (best.value >= limits.most) return best;
    }
    best.bound = best.value;
    if (steps_below > 0) return best;
    if ((!four.any_artificial() && four.least_weight() >= -1e-3) || restarts == kMostRestarts) return best;
    // Not a maximum: the region ends here, or f rises along an edge between three of the four.
    ++restarts;
    four.reset(p, here.value + extent, 64 * (here.value + extent));
  }
  return best;
}

}  // namespace aerate::kernels
