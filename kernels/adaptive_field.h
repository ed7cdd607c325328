#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/ball_grid.h"
#include "kernels/constants.h"
#include "kernels/nearest_point.h"
#include "kernels/packed_shape.h"
#include "kernels/triangle_bvh.h"
#include "kernels/vec.h"
#include "kernels/view.h"
#include "kernels/winding.h"

// The clearance f(x), the largest radius of a void at x, that the adaptive packing places its voids by. For
// balls f(x) = min(distance to the surface - wall, min over placed balls of |x - c| - r - gap). It is
// negative outside the solid and changes by no more than x moves.

namespace aerate::kernels {

template <typename Shape>
struct FieldView {
  TriangleBvhView surface;
  WindingView winding;
  BallGridView<Shape> balls;
  double wall = 0;
};

// Where the signed distance to the surface was last computed, and the facet that was nearest. The distance
// changes by no more than the way walked, so nearby points often need not ask again.
struct SurfaceAnchor {
  Vec3d point;
  // 0 if nothing is known; inside the solid it may be too small, and is, for voids that are no balls, that of
  // the largest void: its radius and the wall.
  double signed_distance;
  std::uint32_t facet;  // may be kNone
};

template <typename Shape>
AERATE_HD inline bool is_inside(const FieldView<Shape>& field, const SurfaceAnchor& anchor, Vec3d p) {
  const double walked_squared = length_squared(p - anchor.point);
  if (walked_squared < anchor.signed_distance * anchor.signed_distance * 0.999999) {
    return anchor.signed_distance > 0;
  }
  return field.winding.winding_number(p) == 1;
}

// The anchor at p, given one nearby.
template <typename Shape>
AERATE_HD inline SurfaceAnchor anchor_at(const FieldView<Shape>& field, const SurfaceAnchor& nearby,
                                         Vec3d p) {
  if constexpr (!Shape::kIsBall) {
    if (is_inside(field, nearby, p)) {
      const WidestVoid widest = field.balls.shape.widest(field.surface, p, field.wall, nearby.facet);
      return {p, widest.radius + field.wall, widest.facet};
    }
  }
  NearestFacet nearest{kInfinity, nearby.facet};
  if (nearby.facet != kNone) {
    nearest.distance_squared = distance_squared_to_facet(p, field.surface.facets[nearby.facet]);
  }
  nearest = field.surface.nearer_than(p, nearest);
  const double distance = std::sqrt(nearest.distance_squared);
  return {p, is_inside(field, nearby, p) ? distance : -distance, nearest.facet};
}

// The same where distances of more than `most_inside`, or `most_outside` on the other side, are of no
// concern: the signed distance is then one of at least that, and the facet any.
template <typename Shape>
AERATE_HD inline SurfaceAnchor anchor_within(const FieldView<Shape>& field, const SurfaceAnchor& nearby,
                                             Vec3d p, double most_inside, double most_outside) {
  const double still_inside = nearby.signed_distance - length(p - nearby.point);
  if (still_inside > max_of(most_inside, 0.0)) return {p, still_inside, nearby.facet};
  const bool inside = is_inside(field, nearby, p);
  if constexpr (!Shape::kIsBall) {
    if (inside) return anchor_at(field, nearby, p);
  }
  // A trifle more, so that what is just as far is found.
  const double most = max_of(inside ? most_inside : most_outside, 0.0) * (1 + 1e-12);
  NearestFacet nearest{most * most, kNone};
  if (nearby.facet != kNone) {
    const double distance_squared = distance_squared_to_facet(p, field.surface.facets[nearby.facet]);
    if (distance_squared < nearest.distance_squared) nearest = {distance_squared, nearby.facet};
  }
  nearest = field.surface.nearer_than(p, nearest);
  const double distance = std::sqrt(nearest.distance_squared);
  return {p, inside ? distance : -distance, nearest.facet != kNone ? nearest.facet : nearby.facet};
}

// The constraint that a facet is at p, which is at `signed_distance` from it.
template <typename Shape>
AERATE_HD inline Clearance facet_clearance(const FieldView<Shape>& field, std::uint32_t facet,
                                           double signed_distance, Vec3d p, double scale) {
  // A plane is a sphere of a large radius.
  constexpr double kPlaneRadii = 256;
  const FacetPoint foot = nearest_point_on_facet(p, field.surface.facets[facet]);
  Clearance result{signed_distance - field.wall, foot.point, field.wall};
  if (foot.feature == FacetFeature::rim && signed_distance > 0) return result;
  Vec3d gradient{0, 0, 0};
  if (signed_distance != 0) gradient = (p - foot.point) * (1.0 / signed_distance);
  const double radius = kPlaneRadii * max_of(std::abs(signed_distance), scale);
  result.centre = p - gradient * radius;
  result.radius = radius - result.value;
  return result;
}

// The constraint that a facet is to a void at p that is no ball: that of the ball of it that touches.
template <typename Shape>
AERATE_HD inline Clearance void_facet_clearance(const FieldView<Shape>& field, std::uint32_t facet, Vec3d p,
                                                double scale) {
  const Shape& shape = field.balls.shape;
  const SpineReach reach = shape.at_facet(field.surface, p, field.wall, facet);
  const double fallen = shape.fall(reach.height);
  const Vec3d rise = shape.rise(reach.height);
  Clearance result = facet_clearance(field, facet, reach.value - fallen + field.wall, p + rise, scale);
  result.value = reach.value;
  result.centre = result.centre - rise;
  result.radius -= fallen;
  return result;
}

// The constraint that a placed void is at p.
template <typename Shape>
AERATE_HD inline Clearance ball_clearance(const FieldView<Shape>& field, const NearestBall& nearest,
                                          Vec3d p) {
  const Ball& ball = field.balls.balls[nearest.ball];
  return field.balls.shape.constraint_beside(p, ball, field.balls.gap, nearest.clearance);
}

// The surface's part of `clearance_at` at a point inside, for voids that are no balls; `result` has the part
// of the voids.
template <typename Shape>
AERATE_HD inline Clearance void_clearance_inside(const FieldView<Shape>& field, SurfaceAnchor& anchor,
                                                 Vec3d p, double limit, double enough,
                                                 const Clearance& result) {
  const Shape& shape = field.balls.shape;
  WidestVoid widest{result.value, kNone};
  if (anchor.facet != kNone) {
    const double known = shape.at_facet(field.surface, p, field.wall, anchor.facet).value;
    if (known < min_of(enough, result.value)) return void_facet_clearance(field, anchor.facet, p, limit);
    if (known < widest.radius) widest = {known, anchor.facet};
  }
  widest = shape.narrower(field.surface, p, field.wall, widest);
  if (widest.facet == kNone) return result;
  anchor = {p, widest.radius + field.wall, widest.facet};
  return void_facet_clearance(field, widest.facet, p, limit);
}

// f(p) clipped to `limit` (where it is clipped, the sphere that comes with it means nothing) and what attains
// it; or, if f(p) < enough, anything that is below `enough` at p, with its value. What is cheap is asked
// first.
template <typename Shape>
AERATE_HD inline Clearance clearance_at(const FieldView<Shape>& field, SurfaceAnchor& anchor, Vec3d p,
                                        double limit, double enough) {
  const NearestBall ball = field.balls.nearest(p, limit);
  Clearance result{ball.clearance, p, 0};
  if (ball.ball != kNone) {
    result = ball_clearance(field, ball, p);
    if (result.value < enough) return result;
  }
  const double walked = length(p - anchor.point);
  if (anchor.signed_distance - walked - field.wall >= result.value) return result;

  const bool inside = is_inside(field, anchor, p);
  if constexpr (!Shape::kIsBall) {
    if (inside) return void_clearance_inside(field, anchor, p, limit, enough, result);
  }
  NearestFacet nearest{kInfinity, anchor.facet};
  if (anchor.facet != kNone) {
    nearest.distance_squared = distance_squared_to_facet(p, field.surface.facets[anchor.facet]);
    if (inside) {
      const double distance = std::sqrt(nearest.distance_squared);
      if (distance - field.wall < min_of(enough, result.value)) {
        return facet_clearance(field, anchor.facet, distance, p, limit);
      }
    }
  }
  const double search = result.value + field.wall;
  if (inside && nearest.distance_squared > search * search) nearest = {search * search, kNone};
  nearest = field.surface.nearer_than(p, nearest);
  if (nearest.facet == kNone) return result;
  const double distance = std::sqrt(nearest.distance_squared);
  anchor = {p, inside ? distance : -distance, nearest.facet};
  if (anchor.signed_distance - field.wall >= result.value) return result;
  return facet_clearance(field, anchor.facet, anchor.signed_distance, p, limit);
}

}  // namespace aerate::kernels
