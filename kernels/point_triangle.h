#pragma once

#include "kernels/facet.h"
#include "kernels/vec.h"

namespace aerate::kernels {

// Squared distance from p to the segment a-b; a may equal b.
AERATE_HD inline double distance_squared_to_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d ab = b - a;
  const Vec3d ap = p - a;
  const double along = dot(ap, ab);
  if (along <= 0) return length_squared(ap);
  const double ab_squared = length_squared(ab);
  if (along >= ab_squared) return length_squared(p - b);
  return length_squared(ap - ab * (along / ab_squared));
}

// Squared distance from p to a triangle, mm2. Slivers and triangles without area are as good as any other:
// the plane is used only where p projects inside all three edges, otherwise the nearest point lies on an edge
// that p is outside of.
AERATE_HD inline double distance_squared_to_facet(Vec3d p, const Facet& facet) {
  const Vec3d a = to_double(facet.a);
  const Vec3d b = to_double(facet.b);
  const Vec3d c = to_double(facet.c);
  const Vec3d normal = cross(b - a, c - a);
  const bool inside_ab = dot(cross(normal, b - a), p - a) > 0;
  const bool inside_bc = dot(cross(normal, c - b), p - b) > 0;
  const bool inside_ca = dot(cross(normal, a - c), p - c) > 0;
  if (inside_ab && inside_bc && inside_ca) {
    const double height = dot(normal, p - a);
    return height * height / length_squared(normal);
  }
  double nearest = 1.7976931348623157e308;
  if (!inside_ab) nearest = min_of(nearest, distance_squared_to_segment(p, a, b));
  if (!inside_bc) nearest = min_of(nearest, distance_squared_to_segment(p, b, c));
  if (!inside_ca) nearest = min_of(nearest, distance_squared_to_segment(p, c, a));
  return nearest;
}

// Is the triangle nearer to p than sqrt(limit_squared)? As `distance_squared_to_facet` says, but most
// triangles are decided by a corner, or by a ball about them or the distance of their plane, which are so far
// off that rounding is no matter.
AERATE_HD inline bool is_facet_nearer(Vec3d p, const Facet& facet, double limit_squared) {
  constexpr double kSurely = 1 + 1e-9;
  const Vec3d a = to_double(facet.a);
  const Vec3d from_a = p - a;
  const double corner_squared = length_squared(from_a);
  if (corner_squared < limit_squared) return true;
  const Vec3d ab = to_double(facet.b) - a;
  const Vec3d ac = to_double(facet.c) - a;
  const double extent_squared = max_of(length_squared(ab), length_squared(ac));
  // |p - a| >= limit + extent, without roots.
  const double beyond = corner_squared - (limit_squared + extent_squared) * kSurely;
  if (beyond > 0 && beyond * beyond > 4 * kSurely * limit_squared * extent_squared) return false;
  const Vec3d normal = cross(ab, ac);
  const double height = dot(normal, from_a);
  if (height * height > kSurely * limit_squared * length_squared(normal)) return false;
  return distance_squared_to_facet(p, facet) < limit_squared;
}

}  // namespace aerate::kernels
