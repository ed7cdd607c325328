#include "printing/roof_top.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "printing/rounding.h"

namespace aerate {
namespace {

// A top this much narrower than the tolerance is made a point.
constexpr double kApexShare = 0.25;

// A cone must be this many steps of fp32 wide, or the ring and the top would run together.
constexpr double kMarginsPerCone = 64;

void add(std::vector<Triangle>& triangles, std::size_t a, std::size_t b, std::size_t c) {
  triangles.push_back(
      {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
}

// A convex polygon of the vertices first, first + 1, ...: a zigzag, which has better angles than a fan.
void close_polygon(std::vector<Triangle>& triangles, std::size_t first, std::size_t count) {
  std::size_t low = 0, high = count - 1;
  while (low + 1 < high) {
    add(triangles, first + low, first + low + 1, first + high);
    ++low;
    if (low + 1 >= high) break;
    add(triangles, first + low, first + high - 1, first + high);
    --high;
  }
}

}  // namespace

double farthest_point(const Roof& roof, double radius) {
  return std::max(radius, std::hypot(roof.top(radius), roof.flat_radius()));
}

double void_rounding_margin(const Roof& roof, const Sphere& sphere) {
  if (!roof.shapes(sphere.radius)) return rounding_margin(sphere);
  return rounding_margin({sphere.centre, farthest_point(roof, sphere.radius), sphere.kind});
}

double void_shrinkage(const Roof& roof, const Sphere& sphere) {
  return void_rounding_margin(roof, sphere) / std::min(sphere.radius, roof.top(sphere.radius));
}

RoofTop roof_top_of(const Roof& roof, const Sphere& sphere, double tolerance) {
  if (roof.flat_radius() <= kApexShare * tolerance) return RoofTop::apex;
  const double cone_width = sphere.radius * roof.cosine - roof.flat_radius();
  return cone_width < kMarginsPerCone * void_rounding_margin(roof, sphere) ? RoofTop::shoulder
                                                                           : RoofTop::flat;
}

std::vector<Triangle> roof_triangles(RoofTop top, std::size_t first, std::size_t count, std::size_t rim) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < count && top != RoofTop::shoulder; ++i) {
    const std::size_t next = (i + 1) % count;
    if (top == RoofTop::apex) {
      add(triangles, first + i, first + next, rim);
    } else {
      add(triangles, first + i, first + next, rim + next);
      add(triangles, first + i, rim + next, rim + i);
    }
  }
  if (top != RoofTop::apex) close_polygon(triangles, top == RoofTop::flat ? rim : first, count);
  return triangles;
}

}  // namespace aerate
