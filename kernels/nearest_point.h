#pragma once

#include "kernels/facet.h"
#include "kernels/point_triangle.h"
#include "kernels/vec.h"

namespace aerate::kernels {

enum class FacetFeature { face, rim };

struct FacetPoint {
  Vec3d point;
  FacetFeature feature;  // rim: on an edge or at a corner
};

AERATE_HD inline Vec3d nearest_point_on_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d ab = b - a;
  const double along = dot(p - a, ab);
  if (along <= 0) return a;
  const double ab_squared = length_squared(ab);
  if (along >= ab_squared) return b;
  return a + ab * (along / ab_squared);
}

// The point of a triangle nearest to p, for directions; distances come from `distance_squared_to_facet`,
// which does not pass through a point and its rounding.
AERATE_HD inline FacetPoint nearest_point_on_facet(Vec3d p, const Facet& facet) {
  const Vec3d a = to_double(facet.a);
  const Vec3d b = to_double(facet.b);
  const Vec3d c = to_double(facet.c);
  const Vec3d normal = cross(b - a, c - a);
  const bool inside_ab = dot(cross(normal, b - a), p - a) > 0;
  const bool inside_bc = dot(cross(normal, c - b), p - b) > 0;
  const bool inside_ca = dot(cross(normal, a - c), p - c) > 0;
  if (inside_ab && inside_bc && inside_ca) {
    return {p - normal * (dot(normal, p - a) / length_squared(normal)), FacetFeature::face};
  }
  Vec3d nearest = nearest_point_on_segment(p, a, b);
  const Vec3d on_bc = nearest_point_on_segment(p, b, c);
  const Vec3d on_ca = nearest_point_on_segment(p, c, a);
  if (length_squared(p - on_bc) < length_squared(p - nearest)) nearest = on_bc;
  if (length_squared(p - on_ca) < length_squared(p - nearest)) nearest = on_ca;
  return {nearest, FacetFeature::rim};
}

}  // namespace aerate::kernels
