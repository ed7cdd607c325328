#include "core/facet_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "kernels/constants.h"
#include "kernels/nearest_point.h"

namespace aerate {
namespace {

using Corners = FacetDistance::Corners;

// Does a point of the plane, or one that projects there, lie within all three sides?
bool holds(const Corners& facet, Vec3d p) {
  const std::array<Vec3d, 3>& at = facet.at;
  return dot(cross(facet.normal, at[1] - at[0]), p - at[0]) >= 0 &&
         dot(cross(facet.normal, at[2] - at[1]), p - at[1]) >= 0 &&
         dot(cross(facet.normal, at[0] - at[2]), p - at[2]) >= 0;
}

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
        holds(b, a.at[i] + (a.at[next] - a.at[i]) * (height[i] / (height[i] - height[next]))))
      return 0;
    const double squared = height[i] * height[i];
    if (area_squared > 0 && squared < least * area_squared && holds(b, a.at[i]))
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
bool is_beyond_plane(const Corners& a, const Corners& b, double limit_squared) {
  const auto height = [&](Vec3d p) { return dot(a.normal, p - a.at[0]); };
  const double first = height(b.at[0]), second = height(b.at[1]), third = height(b.at[2]);
  const double low = std::min({first, second, third}), high = std::max({first, second, third});
  const double needed = limit_squared * length_squared(a.normal);
  return (low > 0 && low * low >= needed) || (high < 0 && high * high >= needed);
}

// Are `a` and `b` farther apart along some way, surely?
bool is_beyond_along(Vec3d way, const Corners& a, const Corners& b, double limit_squared) {
  constexpr double kSurely = 1 + 1e-9;
  const auto along = [&](Vec3d p) { return dot(way, p - a.at[0]); };
  const double end = std::max({0.0, along(a.at[1]), along(a.at[2])});
  const double apart = std::min({along(b.at[0]), along(b.at[1]), along(b.at[2])}) - end;
  return apart > 0 && apart * apart > kSurely * limit_squared * length_squared(way);
}

struct SurfaceMetric {
  FacetDistance distance;
  Box3d box;
  const kernels::TriangleBvhView& surface;

  double bound(const Box3f& other) const {
    return distance_squared(box, {to_double(other.lower), to_double(other.upper)});
  }
  double limit() const { return distance.squared(); }
  void visit(std::uint32_t i) {
    const kernels::Facet& other = surface.facets[i];
    if (bound(kernels::box_of(other)) < distance.squared()) distance.look_at(other);
  }
};

}  // namespace

double distance_squared(const Box3d& a, const Box3d& b) {
  const double x = gap_along(a.lower.x, a.upper.x, b.lower.x, b.upper.x);
  const double y = gap_along(a.lower.y, a.upper.y, b.lower.y, b.upper.y);
  const double z = gap_along(a.lower.z, a.upper.z, b.lower.z, b.upper.z);
  return x * x + y * y + z * z;
}

FacetDistance::Corners::Corners(const kernels::Facet& facet)
    : at{to_double(facet.a), to_double(facet.b), to_double(facet.c)},
      normal(cross(at[1] - at[0], at[2] - at[0])) {}

FacetDistance::FacetDistance(const kernels::Facet& facet, double limit)
    : corners_(facet),
      middle_((corners_.at[0] + corners_.at[1] + corners_.at[2]) * (1.0 / 3)),
      squared_(limit * limit) {
  double farthest = 0;
  for (const Vec3d corner : corners_.at) farthest = std::max(farthest, length_squared(corner - middle_));
  reach_ = std::sqrt(farthest) * (1 + 1e-12);
}

void FacetDistance::look_at(const kernels::Facet& other) {
  const Corners corners(other);
  if (is_beyond_plane(corners, corners_, squared_) || is_beyond_plane(corners_, corners, squared_)) return;
  const double beyond = std::sqrt(squared_) + reach_;
  if (!kernels::is_facet_nearer(middle_, other, beyond * beyond)) return;
  // Nearly the way between the points of both that are nearest to each other.
  const Vec3d way = kernels::nearest_point_on_facet(middle_, other).point - middle_;
  if (is_beyond_along(way, corners_, corners, squared_)) return;
  squared_ = std::min(squared_, distance_squared_between(corners_, corners));
}

double FacetDistance::distance() const {
  return std::sqrt(squared_);
}

double distance_between(const kernels::Facet& a, const kernels::Facet& b) {
  return std::sqrt(distance_squared_between(Corners(a), Corners(b)));
}

double distance_to_surface(const kernels::Facet& facet, const kernels::TriangleBvhView& surface,
                           double limit) {
  const Box3f box = kernels::box_of(facet);
  SurfaceMetric metric{FacetDistance(facet, limit), {to_double(box.lower), to_double(box.upper)}, surface};
  surface.walk(metric);
  return metric.distance.distance();
}

}  // namespace aerate
