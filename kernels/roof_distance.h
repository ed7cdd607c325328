#pragma once

#include <cmath>

#include "kernels/annotations.h"
#include "kernels/constants.h"
#include "kernels/facet.h"
#include "kernels/point_triangle.h"
#include "kernels/roof.h"
#include "kernels/vec.h"

// Distances of voids with roofs (kernels/roof.h) from triangles and from each other, in closed form: the void
// is the union of balls on its spine, so its distance is the least over heights t of that of the spine's
// point, less the radius there.

namespace aerate::kernels {

namespace roof_detail {

// Squared distance from a feature (corner, edge's line, face's plane) to the point at height t of a spine:
// curvature * (t - nearest)^2 + least_squared.
struct Profile {
  double curvature;
  double nearest;
  double least_squared;

  AERATE_HD double distance(double t) const {
    const double offset = t - nearest;
    return std::sqrt(curvature * offset * offset + least_squared);
  }
  // Where on the whole half-line distance + t sine is least, if not at its foot: the ball that would touch
  // first. 0 if the foot is it.
  AERATE_HD double first_touch(double sine) const {
    if (!(curvature > sine * sine) || nearest <= 0) return 0;
    return max_of(0.0, nearest - sine * std::sqrt(least_squared / (curvature * (curvature - sine * sine))));
  }
};

AERATE_HD inline Profile profile_of_point(Vec3d foot, Vec3d up, Vec3d point) {
  const Vec3d offset = point - foot;
  const double height = dot(offset, up);
  return {1, height, length_squared(offset - up * height)};
}

AERATE_HD inline Profile profile_of_line(Vec3d foot, Vec3d up, Vec3d point, Vec3d unit) {
  const Vec3d offset = point - foot;
  const Vec3d across = offset - unit * dot(offset, unit);
  const Vec3d rise = up - unit * dot(up, unit);
  const double curvature = length_squared(rise);
  if (!(curvature > 0)) return {0, 0, length_squared(across)};
  const double nearest = dot(across, rise) / curvature;
  return {curvature, nearest, length_squared(across - rise * nearest)};
}

// Where a void of known size comes nearest: its spine ends at a known height.
struct FixedSpine {
  double sine;
  double end;

  AERATE_HD double height(const Profile& profile) const { return min_of(profile.first_touch(sine), end); }
};

// Where a void touches that has grown until `clearance` is left: its spine grows with it.
struct GrowingSpine {
  double sine;
  double widest_ball;
  double clearance;

  AERATE_HD double height(const Profile& profile) const {
    const double touch = profile.first_touch(sine);
    const double reach = widest_ball + clearance;
    if (!(touch > 0) || profile.distance(touch) >= reach) return touch;
    // The ball at that height would be smaller than the last of the spine, which therefore touches instead.
    return max_of(0.0, profile.nearest -
                           std::sqrt(max_of(0.0, reach * reach - profile.least_squared) / profile.curvature));
  }
};

}  // namespace roof_detail

// distance + t sine at the ball of a spine that meets an obstacle first, and the height t of that ball. A
// void's clearance is this less its radius.
struct SpineReach {
  double value;
  double height;
};

namespace roof_detail {

// Least value over a facet, given the distance of the spine's foot. The distance of a point that moves along
// a line from a convex set is a convex function, so the least value is that of the feature of the facet that
// is nearest where it is attained; features that are nearest there by their line or plane alone are too
// near, and are told by their nearest point lying outside the facet.
template <typename Spine>
AERATE_HD inline SpineReach reach_facet(Vec3d foot, Vec3d up, const Spine& spine, const Facet& facet,
                                        double foot_distance) {
  SpineReach best{foot_distance, 0};
  const auto consider = [&](const Profile& profile, double height) {
    const double value = profile.distance(height) + height * spine.sine;
    if (value < best.value) best = {value, height};
  };
  AERATE_NO_UNROLL
  for (int i = 0; i < 3; ++i) {
    const Profile profile = profile_of_point(foot, up, to_double(facet.corner(i)));
    const double height = spine.height(profile);
    if (height > 0) consider(profile, height);
  }
  AERATE_NO_UNROLL
  for (int i = 0; i < 3; ++i) {
    const Vec3d from = to_double(facet.corner(i));
    const Vec3d along = to_double(facet.corner(i == 2 ? 0 : i + 1)) - from;
    const double extent = length(along);
    if (!(extent > 0)) continue;
    const Vec3d unit = along * (1 / extent);
    const Profile profile = profile_of_line(foot, up, from, unit);
    const double height = spine.height(profile);
    if (!(height > 0)) continue;
    const double position = dot(foot + up * height - from, unit);
    if (position >= 0 && position <= extent) consider(profile, height);
  }
  const Vec3d a = to_double(facet.a);
  const Vec3d b = to_double(facet.b);
  const Vec3d c = to_double(facet.c);
  const Vec3d normal = cross(b - a, c - a);
  const double extent = length(normal);
  if (extent > 0) {
    const Vec3d unit = normal * (1 / extent);
    const double slope = dot(unit, up);
    const double offset = dot(unit, foot - a);
    if (slope != 0) {
      const Profile profile{slope * slope, -offset / slope, 0};
      const double height = spine.height(profile);
      if (height > 0) {
        const Vec3d p = foot + up * height;
        const bool inside = dot(cross(normal, b - a), p - a) >= 0 && dot(cross(normal, c - b), p - b) >= 0 &&
                            dot(cross(normal, a - c), p - c) >= 0;
        if (inside) consider(profile, height);
      }
    }
  }
  return best;
}

}  // namespace roof_detail

// The largest radius of a void at `foot` that leaves `clearance` to a facet, and the height of the spine's
// ball that touches. Exact but for rounding; the foot must be on the facet's inner side for more than
// `clearance`, or the radius is the ball's own, which may be negative.
AERATE_HD inline SpineReach radius_within(const Roof& roof, Vec3d foot, const Facet& facet,
                                          double clearance) {
  const double distance = std::sqrt(distance_squared_to_facet(foot, facet));
  if (!roof.shapes(distance - clearance)) return {distance - clearance, 0};
  SpineReach reach = roof_detail::reach_facet(
      foot, roof.up, roof_detail::GrowingSpine{roof.sine, roof.widest_ball, clearance}, facet, distance);
  reach.value -= clearance;
  return reach;
}

// Distance from a void to a facet, mm; a little less than the real one above the void, where room is kept
// for a ball instead of the flat top. Negative where they overlap.
AERATE_HD inline double distance_to_facet(const Roof& roof, Vec3d centre, double radius, const Facet& facet) {
  const double distance = std::sqrt(distance_squared_to_facet(centre, facet));
  if (!roof.shapes(radius)) return distance - radius;
  const roof_detail::FixedSpine spine{roof.sine, roof.spine(radius)};
  return roof_detail::reach_facet(centre, roof.up, spine, facet, distance).value - radius;
}

// How deep inside the ball and cone of a void, both without end, a facet lies at its deepest.
inline double lateral_depth(const Roof& roof, Vec3d centre, double radius, const Facet& facet) {
  const double distance = std::sqrt(distance_squared_to_facet(centre, facet));
  if (!roof.limits_ceilings()) return radius - distance;
  const roof_detail::FixedSpine spine{roof.sine, kInfinity};
  return radius - roof_detail::reach_facet(centre, roof.up, spine, facet, distance).value;
}

// The largest radius of a void at `foot` that leaves `clearance` to a void that is there already, and the
// height of the ball that touches: positive on the own spine, negative on the other's, since only the
// difference of heights matters and the lowest balls are the largest.
AERATE_HD inline SpineReach radius_beside(const Roof& roof, Vec3d foot, Vec3d centre, double radius,
                                          double clearance) {
  const roof_detail::Profile profile = roof_detail::profile_of_point(foot, roof.up, centre);
  const double room = radius + clearance;
  const double free = length(foot - centre) - room;
  if (profile.nearest > 0) {
    if (!roof.shapes(free)) return {free, 0};
    const double height = roof_detail::GrowingSpine{roof.sine, roof.widest_ball, room}.height(profile);
    if (!(height > 0)) return {free, 0};
    return {profile.distance(height) + height * roof.sine - room, height};
  }
  if (!roof.shapes(radius)) return {free, 0};
  const roof_detail::Profile from_above{1, -profile.nearest, profile.least_squared};
  const double height = roof_detail::FixedSpine{roof.sine, roof.spine(radius)}.height(from_above);
  if (!(height > 0)) return {free, 0};
  return {from_above.distance(height) + height * roof.sine - room, -height};
}

// Distance between two voids, mm, with the same reserve above them as `distance_to_facet`; negative where
// they overlap.
AERATE_HD inline double distance_between(const Roof& roof, Vec3d centre, double radius, Vec3d other_centre,
                                         double other_radius) {
  const double free = length(other_centre - centre) - radius - other_radius;
  roof_detail::Profile profile = roof_detail::profile_of_point(centre, roof.up, other_centre);
  const double lower_radius = profile.nearest > 0 ? radius : other_radius;
  if (!roof.shapes(lower_radius)) return free;
  if (profile.nearest < 0) profile.nearest = -profile.nearest;
  const double height = roof_detail::FixedSpine{roof.sine, roof.spine(lower_radius)}.height(profile);
  if (!(height > 0)) return free;
  return min_of(free, profile.distance(height) + height * roof.sine - radius - other_radius);
}

}  // namespace aerate::kernels
