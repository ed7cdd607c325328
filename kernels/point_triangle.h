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

}  // namespace aerate::kernels
