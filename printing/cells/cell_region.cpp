#include "printing/cells/cell_region.h"

#include <cmath>

#include "kernels/nearest_point.h"
#include "kernels/point_triangle.h"

namespace aerate {

SurfaceNearby CellRegion::surface_near(Vec3d p, double limit, std::uint32_t hint) const {
  kernels::NearestFacet best{limit * limit, kNone};
  if (hint != kNone) {
    const double squared = kernels::distance_squared_to_facet(p, near_.facet(hint));
    if (squared < best.distance_squared) best = {squared, hint};
  }
  best = near_.nearer_than(p, best);
  return {std::sqrt(best.distance_squared), best.facet};
}

Vec3d CellRegion::nearest_on(std::uint32_t facet, Vec3d p) const {
  return kernels::nearest_point_on_facet(p, near_.facet(facet)).point;
}

}  // namespace aerate
