#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/roof_distance.h"
#include "kernels/triangle_bvh.h"
#include "kernels/vec.h"
#include "kernels/view.h"

namespace aerate::kernels {

// The largest radius of a void with a roof that keeps off the surface, and the facet that it touches.
struct WidestVoid {
  double radius;
  std::uint32_t facet;  // position in the hierarchy's own order, or kNone
};

namespace roofed_surface_detail {

// At most what (distance to a box + t sine) is anywhere on a spine. Along it the distance changes by no more
// than the height t does, whichever end it is known at, so it is least where the two bounds meet.
AERATE_HD inline double least_along_spine(const Roof& roof, Vec3d foot, double spine, const Box3f& box) {
  const double at_foot = std::sqrt(distance_squared_to_box(foot, box));
  if (!(spine > 0)) return at_foot;
  const double at_end = std::sqrt(distance_squared_to_box(foot + roof.up * spine, box));
  const double height = min_of(max_of(0.5 * (at_foot - at_end + spine), 0.0), spine);
  return at_foot - (1 - roof.sine) * height;
}

struct RadiusMetric {
  Roof roof;
  Vec3d foot;
  double clearance;
  WidestVoid best;
  double spine;  // of a void of the radius so far
  View<const Facet> facets;

  AERATE_HD double bound(const Box3f& box) const {
    return least_along_spine(roof, foot, spine, box) - clearance;
  }

  AERATE_HD double limit() const { return best.radius; }

  AERATE_HD void visit(std::uint32_t i) {
    const double reach = best.radius + clearance + (1 - roof.sine) * spine;
    if (!is_facet_nearer(foot, facets[i], reach * reach) || !may_be_narrower(facets[i])) return;
    const double radius = radius_within(roof, foot, facets[i], clearance).value;
    if (radius < best.radius) {
      best = {radius, i};
      spine = roof.spine(radius);
    }
  }

 private:
  // By one corner: from there to any point of the facet the value changes by no more than the way.
  AERATE_HD bool may_be_narrower(const Facet& facet) const {
    const Vec3d corner = to_double(facet.a);
    const double extent_squared =
        max_of(length_squared(to_double(facet.b) - corner), length_squared(to_double(facet.c) - corner));
    const roof_detail::Profile profile = roof_detail::profile_of_point(foot, roof.up, corner);
    const double height = roof_detail::FixedSpine{roof.sine, spine}.height(profile);
    const double excess = profile.distance(height) + height * roof.sine - clearance - best.radius;
    return excess <= 0 || excess * excess <= extent_squared * (1 + 1e-9);
  }
};

// Distance along a spine of known height.
struct DistanceMetric {
  Roof roof;
  Vec3d centre;
  double radius;
  double best;
  View<const Facet> facets;

  AERATE_HD double bound(const Box3f& box) const {
    return least_along_spine(roof, centre, roof.spine(radius), box) - radius;
  }
  AERATE_HD double limit() const { return best; }
  AERATE_HD void visit(std::uint32_t i) {
    best = min_of(best, distance_to_facet(roof, centre, radius, facets[i]));
  }
};

}  // namespace roofed_surface_detail

// The largest void at `foot`, inside the surface, that keeps `clearance` from it, if it is smaller than
// `best`, whose radius must be finite and more than -clearance.
AERATE_HD inline WidestVoid narrower_than(const TriangleBvhView& surface, const Roof& roof, Vec3d foot,
                                          double clearance, WidestVoid best) {
  roofed_surface_detail::RadiusMetric metric{roof,          foot, clearance, best, roof.spine(best.radius),
                                             surface.facets};
  surface.walk(metric);
  return metric.best;
}

// The same where nothing is known.
AERATE_HD inline WidestVoid widest_void(const TriangleBvhView& surface, const Roof& roof, Vec3d foot,
                                        double clearance) {
  const NearestFacet nearest = surface.nearest(foot, kInfinity);
  const double ball = std::sqrt(nearest.distance_squared) - clearance;
  if (!roof.shapes(ball)) return {ball, nearest.facet};
  return narrower_than(surface, roof, foot, clearance, {ball, nearest.facet});
}

// Distance from a void to the surface, with the reserve above it that `distance_to_facet` has.
AERATE_HD inline double distance_to_surface(const TriangleBvhView& surface, const Roof& roof, Vec3d centre,
                                            double radius) {
  const NearestFacet nearest = surface.nearest(centre, kInfinity);
  const double ball = std::sqrt(nearest.distance_squared) - radius;
  if (!roof.shapes(radius)) return ball;
  roofed_surface_detail::DistanceMetric metric{roof, centre, radius, ball, surface.facets};
  surface.walk(metric);
  return metric.best;
}

}  // namespace aerate::kernels
