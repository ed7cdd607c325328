#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "kernels/winding.h"

namespace aerate {

// Where a line along z passes through a facet.
struct LineCrossing {
  double z;
  int sign;  // +1 on leaving the solid upwards
  std::uint32_t facet;
};

inline double height_at(const kernels::Facet& facet, double x, double y) {
  const Vec3d a = to_double(facet.a);
  const Vec3d b = to_double(facet.b);
  const Vec3d c = to_double(facet.c);
  const Vec3d normal = cross(b - a, c - a);
  const double z = a.z - (normal.x * (x - a.x) + normal.y * (y - a.y)) / normal.z;
  // A facet nearly parallel to the line has no accurate height, but it has bounds.
  const double lowest = std::min({a.z, b.z, c.z});
  const double highest = std::max({a.z, b.z, c.z});
  return std::isnan(z) ? lowest : std::clamp(z, lowest, highest);
}

// Calls f(crossing) for those of the line through (x, y), in any order.
template <typename F>
void for_each_crossing(const kernels::WindingView& winding, double x, double y, const F& f) {
  winding.for_each_near(x, y, [&](std::uint32_t facet) {
    const int sign = kernels::winding_detail::line_crossing(winding.facets[facet], x, y);
    if (sign != 0) f(LineCrossing{height_at(winding.facets[facet], x, y), sign, facet});
  });
}

}  // namespace aerate
