#include "core/facet_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "kernels/constants.h"

namespace aerate {
namespace {

// The corners of a facet and its normal, not of unit length.
struct Corners {
  std::array<Vec3d, 3> at;
  Vec3d normal;

  explicit Corners(const kernels::Facet& facet)
      : at{to_double(facet.a), to_double(facet.b), to_double(facet.c)},
        normal(cross(at[1] - at[0], at[2] - at[0])) {}

  // Does a point of the plane, or one that projects there, lie within all three sides?
  bool holds(Vec3d p) const {
    return dot(cross(normal, at[1] - at[0]), p - at[0]) >= 0 &&
           dot(cross(normal, at[2] - at[1]), p - at[1]) >= 0 &&
           dot(cross(normal, at[0] - at[2]), p - at[2]) >= 0;
  }
};

double clamped(double x) {
  return x < 0 ? 0 : x > 1 ? 1 : x;
}

// Squared distance of two segments (C. Ericson, "Real-Time Collision Detection", 2005, 5.1.9).
double distance_squared(Vec3d a, Vec3d a_end, Vec3d b, Vec3d b_end) {
  const Vec3d along_a = a_end - a, along_b = b_end - b, between = a - b;
  const double aa = length_squared(along_a), bb = length_squared(along_b), ab = dot(along_a, along_b);
  const double c = dot(along_a, between), f = dot(along_b, between);
  const double determinant = aa * bb - ab * ab;
  double s = determinant > 0 ? clamped((ab * f - c * bb) / determinant) : 0;
  double t = bb > 0 ? (ab * s + f) / bb : 0;
  if (t < 0 || t > 1) {
    t = clamped(t);
    s = aa > 0 ? clamped((ab * t - c) / aa) : 0;
  }
  return length_squared(between + along_a * s - along_b * t);
}

// Of the corners of `a` whose nearest point of `b` is not on its sides; 0 if a side of `a` passes through `b`.
double distance_squared_across(const Corners& a, const Corners& b) {
  const double area_squared = length_squared(b.normal);
  std::array<double, 3> height;
  for (std::size_t i = 0; i < 3; ++i) height[i] = dot(b.normal, a.at[i] - b.at[0]);
  double least = kInfinity;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    if ((height[i] > 0) != (height[next] > 0) && height[i] != height[next] &&
        b.holds(a.at[i] + (a.at[next] - a.at[i]) * (height[i] / (height[i] - height[next]))))
      return 0;
    const double squared = height[i] * height[i];
    if (area_squared > 0 && squared < least * area_squared && b.holds(a.at[i]))
      least = squared / area_squared;
  }
  return least;
}

double distance_squared_between(const Corners& a, const Corners& b) {
  double least = std::min(distance_squared_across(a, b), distance_squared_across(b, a));
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      least = std::min(least, distance_squared(a.at[i], a.at[(i + 1) % 3], b.at[j], b.at[(j + 1) % 3]));
  }
  return least;
}

double gap_along(double a_lower, double a_upper, double b_lower, double b_upper) {
  return std::max({0.0, b_lower - a_upper, a_lower - b_upper});
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
  Corners corners;
  Box3d box;
  Vec3d middle;
  double reach;  // of the corners from there
  const kernels::TriangleBvhView& surface;
  double best_squared;

  double bound(const Box3f& other) const {
    return distance_squared(box, {to_double(other.lower), to_double(other.upper)});
  }
  double limit() const { return best_squared; }
  void visit(std::uint32_t i) {
    const kernels::Facet& other = surface.facets[i];
    if (bound(kernels::box_of(other)) >= best_squared) return;
    if (is_beyond_plane(other, facet, best_squared) || is_beyond_plane(facet, other, best_squared)) return;
    const double beyond = std::sqrt(best_squared) + reach;
    if (!kernels::is_facet_nearer(middle, other, beyond * beyond)) return;
    best_squared = std::min(best_squared, distance_squared_between(corners, Corners(other)));
  }
};

}  // namespace

double distance_squared(const Box3d& a, const Box3d& b) {
  const double x = gap_along(a.lower.x, a.upper.x, b.lower.x, b.upper.x);
  const double y = gap_along(a.lower.y, a.upper.y, b.lower.y, b.upper.y);
  const double z = gap_along(a.lower.z, a.upper.z, b.lower.z, b.upper.z);
  return x * x + y * y + z * z;
}

double distance_between(const kernels::Facet& a, const kernels::Facet& b) {
  return std::sqrt(distance_squared_between(Corners(a), Corners(b)));
}

double distance_to_surface(const kernels::Facet& facet, const kernels::TriangleBvhView& surface,
                           double limit) {
  const Box3f box = kernels::box_of(facet);
  const Vec3d a = to_double(facet.a), b = to_double(facet.b), c = to_double(facet.c);
  const Vec3d middle = (a + b + c) * (1.0 / 3);
  const double reach = std::sqrt(
      std::max({length_squared(a - middle), length_squared(b - middle), length_squared(c - middle)}));
  TriangleMetric metric{facet,        Corners(facet),      {to_double(box.lower), to_double(box.upper)},
                        middle,       reach * (1 + 1e-12), surface,
                        limit * limit};
  surface.walk(metric);
  return std::sqrt(metric.best_squared);
}

}  // namespace aerate
