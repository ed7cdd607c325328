#include "core/facet_distance.h"

#include <algorithm>
#include <cmath>

#include "core/segment_distance.h"

namespace aerate {
namespace {

Segment side_of(const kernels::Facet& facet, int i) {
  return {to_double(facet.corner(i)), to_double(facet.corner((i + 1) % 3))};
}

double gap_along(double a_lower, double a_upper, double b_lower, double b_upper) {
  return std::max({0.0, b_lower - a_upper, a_lower - b_upper});
}

double distance_squared(const Box3d& a, const Box3f& other) {
  const Box3d b{to_double(other.lower), to_double(other.upper)};
  const double x = gap_along(a.lower.x, a.upper.x, b.lower.x, b.upper.x);
  const double y = gap_along(a.lower.y, a.upper.y, b.lower.y, b.upper.y);
  const double z = gap_along(a.lower.z, a.upper.z, b.lower.z, b.upper.z);
  return x * x + y * y + z * z;
}

// Lies `b` on one side of the plane of `a`, farther from it than the root of `limit_squared`? What cannot be told
// for rounding is not.
bool is_beyond_plane(const kernels::Facet& a, const kernels::Facet& b, double limit_squared) {
  const Vec3d origin = to_double(a.a);
  const Vec3d normal = cross(to_double(a.b) - origin, to_double(a.c) - origin);
  const auto height = [&](Vec3f p) { return dot(normal, to_double(p) - origin); };
  const double first = height(b.a), second = height(b.b), third = height(b.c);
  const double low = std::min({first, second, third}), high = std::max({first, second, third});
  const double needed = limit_squared * length_squared(normal);
  return (low > 0 && low * low >= needed) || (high < 0 && high * high >= needed);
}

struct TriangleMetric {
  const kernels::Facet& facet;
  Box3d box;
  Vec3d middle;
  double reach;  // of the corners from there
  const kernels::TriangleBvhView& surface;
  double best_squared;

  double bound(const Box3f& other) const { return distance_squared(box, other); }
  double limit() const { return best_squared; }
  void visit(std::uint32_t i) {
    const kernels::Facet& other = surface.facets[i];
    if (bound(kernels::box_of(other)) >= best_squared) return;
    if (is_beyond_plane(other, facet, best_squared) || is_beyond_plane(facet, other, best_squared)) return;
    const double beyond = std::sqrt(best_squared) + reach;
    if (!kernels::is_facet_nearer(middle, other, beyond * beyond)) return;
    const double distance = distance_between(facet, other);
    best_squared = std::min(best_squared, distance * distance);
  }
};

}  // namespace

double distance_between(const kernels::Facet& a, const kernels::Facet& b) {
  double least = distance_to_facet(side_of(a, 0), b);
  for (int i = 0; i < 3; ++i)
    least = std::min({least, distance_to_facet(side_of(a, i), b), distance_to_facet(side_of(b, i), a)});
  return least;
}

double distance_to_surface(const kernels::Facet& facet, const kernels::TriangleBvhView& surface,
                           double limit) {
  const Box3f box = kernels::box_of(facet);
  const Vec3d a = to_double(facet.a), b = to_double(facet.b), c = to_double(facet.c);
  const Vec3d middle = (a + b + c) * (1.0 / 3);
  const double reach = std::sqrt(
      std::max({length_squared(a - middle), length_squared(b - middle), length_squared(c - middle)}));
  TriangleMetric metric{facet,   {to_double(box.lower), to_double(box.upper)},
                        middle,  reach * (1 + 1e-12),
                        surface, limit * limit};
  surface.walk(metric);
  return std::sqrt(metric.best_squared);
}

}  // namespace aerate
