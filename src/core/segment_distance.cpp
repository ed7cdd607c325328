#include "core/segment_distance.h"

#include <algorithm>
#include <cmath>

#include "kernels/point_triangle.h"

namespace aerate {
namespace {

// Does the segment pass through the triangle, strictly between its ends? Where it only touches an edge or
// lies in the plane, the distances to the edges are 0 already.
bool pierces(const Segment& segment, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d normal = cross(b - a, c - a);
  const double from = dot(normal, segment.start - a);
  const double to = dot(normal, segment.end - a);
  if ((from > 0) == (to > 0) || from == to) return false;
  const Vec3d p = segment.start + (segment.end - segment.start) * (from / (from - to));
  return dot(cross(normal, b - a), p - a) >= 0 && dot(cross(normal, c - b), p - b) >= 0 &&
         dot(cross(normal, a - c), p - c) >= 0;
}

}  // namespace

double distance_to_point(const Segment& segment, Vec3d point) {
  return std::sqrt(kernels::distance_squared_to_segment(point, segment.start, segment.end));
}

double distance_between(const Segment& a, const Segment& b) {
  const Vec3d da = a.end - a.start;
  const Vec3d db = b.end - b.start;
  const Vec3d between = a.start - b.start;
  const double aa = length_squared(da), bb = length_squared(db), ab = dot(da, db);
  const double determinant = aa * bb - ab * ab;
  // The nearest points lie inside both segments, or one of them is an end.
  double nearest = std::min({distance_to_point(b, a.start), distance_to_point(b, a.end),
                             distance_to_point(a, b.start), distance_to_point(a, b.end)});
  if (determinant > 0) {
    const double s = (ab * dot(db, between) - bb * dot(da, between)) / determinant;
    const double t = (aa * dot(db, between) - ab * dot(da, between)) / determinant;
    if (s > 0 && s < 1 && t > 0 && t < 1) nearest = std::min(nearest, length(between + da * s - db * t));
  }
  return nearest;
}

double distance_to_facet(const Segment& segment, const kernels::Facet& facet) {
  const Vec3d a = to_double(facet.a), b = to_double(facet.b), c = to_double(facet.c);
  if (pierces(segment, a, b, c)) return 0;
  return std::min({std::sqrt(kernels::distance_squared_to_facet(segment.start, facet)),
                   std::sqrt(kernels::distance_squared_to_facet(segment.end, facet)),
                   distance_between(segment, {a, b}), distance_between(segment, {b, c}),
                   distance_between(segment, {c, a})});
}

}  // namespace aerate
