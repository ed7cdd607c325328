#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/ball_grid.h"
#include "kernels/nearest_point.h"
#include "kernels/triangle_bvh.h"
#include "kernels/vec.h"
#include "kernels/view.h"
#include "kernels/winding.h"

// The clearance f(x) = min(distance to the surface - wall, min over placed balls of |x - c| - r - gap),
// negative outside the solid, that the adaptive packing places its balls by.

namespace aerate::kernels {

// A value of f with what attains it, as a function that is easy to work with near p: |x - centre| - radius.
struct Clearance {
  double value;
  Vec3d centre;
  double radius;
};

struct FieldView {
  TriangleBvhView surface;
  WindingView winding;
  BallGridView balls;
  double wall = 0;
};

// Where the signed distance to the surface was last computed, and the facet that was nearest. The distance
// changes by no more than the way walked, so nearby points often need not ask again.
struct SurfaceAnchor {
  Vec3d point;
  double signed_distance;  // 0 if nothing is known; inside the solid it may be too small
  std::uint32_t facet;     // may be kNoFacet
};

AERATE_HD inline bool is_inside(const FieldView& field, const SurfaceAnchor& anchor, Vec3d p) {
  const double walked_squared = length_squared(p - anchor.point);
  if (walked_squared < anchor.signed_distance * anchor.signed_distance * 0.999999) {
    return anchor.signed_distance > 0;
  }
  return field.winding.winding_number(p) == 1;
}

// The anchor at p, given one nearby.
AERATE_HD inline SurfaceAnchor anchor_at(const FieldView& field, const SurfaceAnchor& nearby, Vec3d p) {
  NearestFacet nearest{kUnbounded, nearby.facet};
  if (nearby.facet != kNoFacet) {
    nearest.distance_squared = distance_squared_to_facet(p, field.surface.facets[nearby.facet]);
  }
  nearest = field.surface.nearer_than(p, nearest);
  const double distance = std::sqrt(nearest.distance_squared);
  return {p, is_inside(field, nearby, p) ? distance : -distance, nearest.facet};
}

// The same where distances of more than `most_inside`, or `most_outside` on the other side, are of no
// concern: the signed distance is then one of at least that, and the facet any.
AERATE_HD inline SurfaceAnchor anchor_within(const FieldView& field, const SurfaceAnchor& nearby, Vec3d p,
                                             double most_inside, double most_outside) {
  const double still_inside = nearby.signed_distance - length(p - nearby.point);
  if (still_inside > max_of(most_inside, 0.0)) return {p, still_inside, nearby.facet};
  const bool inside = is_inside(field, nearby, p);
  // A trifle more, so that what is just as far is found.
  const double most = max_of(inside ? most_inside : most_outside, 0.0) * (1 + 1e-12);
  NearestFacet nearest{most * most, kNoFacet};
  if (nearby.facet != kNoFacet) {
    const double distance_squared = distance_squared_to_facet(p, field.surface.facets[nearby.facet]);
    if (distance_squared < nearest.distance_squared) nearest = {distance_squared, nearby.facet};
  }
  nearest = field.surface.nearer_than(p, nearest);
  const double distance = std::sqrt(nearest.distance_squared);
  return {p, inside ? distance : -distance, nearest.facet != kNoFacet ? nearest.facet : nearby.facet};
}

// The constraint that a facet is at p, which is at `signed_distance` from it.
AERATE_HD inline Clearance facet_clearance(const FieldView& field, std::uint32_t facet,
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

// f(p) clipped to `limit` (where it is clipped, the sphere that comes with it means nothing) and what attains
// it; or, if f(p) < enough, anything that is below `enough` at p, with its value. What is cheap is asked
// first.
AERATE_HD inline Clearance clearance_at(const FieldView& field, SurfaceAnchor& anchor, Vec3d p, double limit,
                                        double enough) {
  const NearestBall ball = field.balls.nearest(p, limit);
  Clearance result{ball.clearance, p, 0};
  if (ball.ball != kNoBall) {
    const Ball& b = field.balls.balls[ball.ball];
    result.centre = b.centre;
    result.radius = b.radius + field.balls.gap;
    if (result.value < enough) return result;
  }
  const double walked = length(p - anchor.point);
  if (anchor.signed_distance - walked - field.wall >= result.value) return result;

  const bool inside = is_inside(field, anchor, p);
  NearestFacet nearest{kUnbounded, anchor.facet};
  if (anchor.facet != kNoFacet) {
    nearest.distance_squared = distance_squared_to_facet(p, field.surface.facets[anchor.facet]);
    if (inside) {
      const double distance = std::sqrt(nearest.distance_squared);
      if (distance - field.wall < min_of(enough, result.value)) {
        return facet_clearance(field, anchor.facet, distance, p, limit);
      }
    }
  }
  const double search = result.value + field.wall;
  if (inside && nearest.distance_squared > search * search) nearest = {search * search, kNoFacet};
  nearest = field.surface.nearer_than(p, nearest);
  if (nearest.facet == kNoFacet) return result;
  const double distance = std::sqrt(nearest.distance_squared);
  anchor = {p, inside ? distance : -distance, nearest.facet};
  if (anchor.signed_distance - field.wall >= result.value) return result;
  return facet_clearance(field, anchor.facet, anchor.signed_distance, p, limit);
}

}  // namespace aerate::kernels
