#include "check/check_kept.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "check/check_failure.h"
#include "check/measure_errors.h"
#include "check/polled_loop.h"
#include "core/facet_distance.h"
#include "kernels/constants.h"

namespace aerate {
namespace {

constexpr std::size_t kPlacesPerPiece = std::size_t{1} << 14;

// What is taken out keeps away from the surface of regions, so that few points tell for all that it is connected with.
void require_outside(const Mesh& read_back, const Expected& expected) {
  constexpr std::size_t kBetween = 97;
  for (const SolidPart& part : expected.solid.parts) {
    if (part.first_triangle < expected.solid.outer_triangle_count()) continue;
    for (std::size_t i = part.first_triangle; i < part.end(); i += kBetween) {
      const Vec3d p = to_double(read_back.positions[read_back.triangles[i][0]]);
      if (expected.kept->holds(p))
        fail_check("something is taken out of a region that stays solid, near ({:.3f}, {:.3f}, {:.3f}) mm",
                   p.x, p.y, p.z);
    }
  }
}

// Of all triangles that are not outside, if less than a limit, which it is else.
double least_distance(const Mesh& read_back, const Expected& expected, double limit, Monitor& monitor) {
  const std::size_t first = expected.solid.outer_triangle_count();
  std::vector<double> distances(read_back.triangles.size() - first);
  for_each_polled(distances.size(), kPlacesPerPiece, monitor, [&](std::size_t i) {
    distances[i] = distance_to_surface(facet_of(read_back, read_back.triangles[first + i]),
                                       expected.kept->within.bvh(), limit);
  });
  double least = limit;
  for (const double distance : distances) least = std::min(least, distance);
  return least;
}

}  // namespace

double check_kept(const Mesh& read_back, const Expected& expected, Monitor& monitor) {
  require_outside(read_back, expected);
  if (expected.kept->within.bvh().facets.size == 0) return kInfinity;
  const double wall = expected.packing.limits.wall;
  const double farthest =
      length(to_double(bounding_box(read_back).upper) - to_double(bounding_box(read_back).lower));
  // Most are farther than a little more than the wall, and cost little then.
  for (double limit = std::max(wall, 0.1) * 1.5;; limit *= 2) {
    const double least = least_distance(read_back, expected, limit, monitor);
    // Pieces of the regions' surface are rounded, as cuts of tubes are.
    const double rounding = kLimitError + kRoundingShare * std::max(1.0, largest_coordinate(read_back));
    if (least < wall - rounding)
      fail_check("{:.9g} mm are left beside a region that stays solid, the wall is {:.9g} mm", least, wall);
    if (least < limit || limit > farthest) return least;
  }
}

}  // namespace aerate
