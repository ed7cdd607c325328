#include "packing/verify.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>

#include "kernels/constants.h"
#include "kernels/roof_distance.h"
#include "kernels/roofed_surface.h"
#include "kernels/triangle_bvh.h"
#include "packing/sphere_pairs.h"

namespace aerate {
namespace {

// A model's own fp32 coordinates are not better than this share of its size.
constexpr double kRoundingShare = 1e-6;

double size_of(const SurfaceIndex& surface) {
  const Box3d box = surface.winding().box;
  return std::max(length(box.upper - box.lower), 0.0);
}

// A radius a little below `limit`, so that sums that were rounded once more still keep it.
double just_below(double limit) {
  return limit - 4 * std::numeric_limits<double>::epsilon() * std::abs(limit);
}

// What a sphere loses: nothing, a little, or all (radius 0).
double checked_radius(const Sphere& sphere, double allowed, double tolerance) {
  if (sphere.radius <= allowed) return sphere.radius;
  return sphere.radius - allowed <= tolerance ? just_below(allowed) : 0.0;
}

double distance_of(const kernels::TriangleBvhView& bvh, Vec3d point, double limit) {
  return std::sqrt(bvh.nearest(point, limit * limit).distance_squared);
}

// Distance of each void to the surface.
std::vector<double> walls_of(const SurfaceIndex& surface, std::span<const Sphere> spheres, const Roof& roof) {
  std::vector<double> walls(spheres.size());
  tbb::parallel_for(std::size_t{0}, spheres.size(), [&](std::size_t i) {
    walls[i] = kernels::distance_to_surface(surface.bvh(), roof, spheres[i].centre, spheres[i].radius);
  });
  return walls;
}

// The largest radius that the wall allows; of a sphere that keeps the wall, something not below its own.
double radius_allowed_by_wall(const kernels::TriangleBvhView& bvh, const Sphere& sphere,
                              const PackingLimits& limits) {
  if (limits.roof.shapes(sphere.radius)) {
    return kernels::widest_void(bvh, limits.roof, sphere.centre, limits.wall).radius;
  }
  const double needed = sphere.radius + limits.wall;
  return distance_of(bvh, sphere.centre, needed * (1 + 1e-9)) - limits.wall;
}

// The largest radius of `smaller` that the gap to `larger` allows.
double radius_allowed_by_gap(Vec3d smaller, Vec3d larger, double larger_radius, const PackingLimits& limits) {
  return kernels::radius_beside(limits.roof, smaller, larger, larger_radius, limits.gap).value;
}

}  // namespace

Packing verify_packing(const SurfaceIndex& surface, Packing packing) {
  if (packing.spheres.empty()) return packing;
  const PackingLimits& limits = packing.limits;
  const double tolerance = kRoundingShare * size_of(surface);

  std::vector<double> radii(packing.spheres.size());
  tbb::parallel_for(std::size_t{0}, packing.spheres.size(), [&](std::size_t i) {
    const Sphere& sphere = packing.spheres[i];
    const bool is_inside = surface.winding().winding_number(sphere.centre) == 1;
    radii[i] = is_inside
                   ? checked_radius(sphere, radius_allowed_by_wall(surface.bvh(), sphere, limits), tolerance)
                   : 0.0;
  });
  for (const SpherePair& pair : find_pairs_within(packing.spheres, limits.gap, limits.roof)) {
    double& first = radii[pair.first];
    double& second = radii[pair.second];
    if (first == 0 || second == 0) continue;
    // The smaller gives way; of two equal ones, the later.
    const bool first_gives = first < second;
    double& smaller = first_gives ? first : second;
    const double larger = std::max(first, second);
    const Vec3d centre = packing.spheres[first_gives ? pair.first : pair.second].centre;
    const Vec3d other = packing.spheres[first_gives ? pair.second : pair.first].centre;
    const double allowed = radius_allowed_by_gap(centre, other, larger, limits);
    if (smaller <= allowed) continue;
    smaller = smaller - allowed <= tolerance ? std::max(just_below(allowed), 0.0) : 0.0;
  }

  std::size_t kept = 0;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    Sphere sphere = packing.spheres[i];
    const bool is_shrunk = radii[i] < sphere.radius;
    // What is smaller by rounding alone is not below the limit.
    if (radii[i] <= 0 || radii[i] < limits.min_radius - tolerance) {
      ++packing.statistics.dropped_by_verification;
      continue;
    }
    if (is_shrunk) ++packing.statistics.shrunk_by_verification;
    sphere.radius = radii[i];
    packing.spheres[kept++] = sphere;
  }
  packing.spheres.resize(kept);
  return packing;
}

std::optional<PackingFault> find_fault(const SurfaceIndex& surface, const Packing& packing) {
  const double tolerance = kRoundingShare * size_of(surface);
  const std::vector<double> walls = walls_of(surface, packing.spheres, packing.limits.roof);
  std::vector<int> winding(packing.spheres.size());
  tbb::parallel_for(std::size_t{0}, winding.size(), [&](std::size_t i) {
    winding[i] = surface.winding().winding_number(packing.spheres[i].centre);
  });

  std::optional<PackingFault> first;
  for (std::size_t i = 0; i < walls.size() && !first; ++i) {
    const double wall = walls[i];
    if (winding[i] != 1) {
      const auto kind = winding[i] == 0 ? PackingFault::Kind::outside : PackingFault::Kind::overlapped_region;
      first = PackingFault{kind, i, i, wall};
    } else if (wall < packing.limits.wall - tolerance) {
      first = PackingFault{PackingFault::Kind::wall, i, i, wall};
    } else if (packing.spheres[i].radius < packing.limits.min_radius - tolerance) {
      first = PackingFault{PackingFault::Kind::too_small, i, i, wall};
    } else if (packing.spheres[i].radius > packing.limits.max_radius + tolerance) {
      first = PackingFault{PackingFault::Kind::too_large, i, i, wall};
    }
  }
  for (const SpherePair& pair : find_pairs_within(packing.spheres, packing.limits.gap, packing.limits.roof)) {
    if (pair.gap >= packing.limits.gap - tolerance) continue;
    if (!first || pair.second < first->sphere) {
      first = PackingFault{PackingFault::Kind::gap, pair.second, pair.first, pair.gap};
    }
  }
  return first;
}

Clearances measure_clearances(const SurfaceIndex& surface, std::span<const Sphere> spheres,
                              const Roof& roof) {
  Clearances clearances{kInfinity, std::nullopt};
  if (spheres.empty()) return clearances;
  double smallest_radius = kInfinity;
  for (const Sphere& sphere : spheres) smallest_radius = std::min(smallest_radius, sphere.radius);
  for (const double wall : walls_of(surface, spheres, roof))
    clearances.wall = std::min(clearances.wall, wall);
  if (spheres.size() < 2) return clearances;
  // Widen the search until a pair is in it.
  for (double reach = std::max(smallest_radius, 1e-3);; reach *= 2) {
    double gap = kInfinity;
    for (const SpherePair& pair : find_pairs_within(spheres, reach, roof)) gap = std::min(gap, pair.gap);
    if (gap < kInfinity) {
      clearances.gap = gap;
      return clearances;
    }
  }
}

}  // namespace aerate
