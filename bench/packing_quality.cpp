#include "bench/packing_quality.h"

#include <cstdio>
#include <fmt/format.h>
#include <vector>

#include "core/surface_index.h"
#include "packing/sphere_pairs.h"

namespace aerate::bench {

Violations count_violations(const Mesh& mesh, std::span<const Sphere> spheres, const PackingLimits& limits,
                            double slack) {
  const SurfaceIndex surface(mesh);
  std::vector<Vec3d> centres;
  for (const Sphere& sphere : spheres) centres.push_back(sphere.centre);
  const std::vector<double> distances = surface.distances(centres);
  Violations violations;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (distances[i] - spheres[i].radius < limits.wall - slack) ++violations.wall;
    if (surface.winding().winding_number(centres[i]) != 1) ++violations.winding;
  }
  for (const SpherePair& pair : find_pairs_within(spheres, limits.gap)) {
    if (pair.gap < limits.gap - slack) ++violations.gap;
  }
  return violations;
}

std::string to_cell(const Violations& violations) {
  return fmt::format("{} {} {}", violations.wall, violations.gap, violations.winding);
}

bool report_broken(std::size_t broken) {
  if (broken > 0) fmt::print(stderr, "{} walls, gaps and winding numbers are broken\n", broken);
  return broken == 0;
}

double density_of(const Mesh& mesh, std::span<const Sphere> spheres) {
  Packing packing;
  packing.spheres.assign(spheres.begin(), spheres.end());
  return 100 * total_volume(packing) / signed_volume(mesh);
}

}  // namespace aerate::bench
