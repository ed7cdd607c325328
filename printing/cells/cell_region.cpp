#include "printing/cells/cell_region.h"

#include <cmath>

#include "kernels/nearest_point.h"
#include "kernels/point_triangle.h"

namespace aerate {

SurfaceNearby CellRegion::surface_near(Vec3d p, double limit, std::uint32_t hint) const {
  const kernels::TriangleBvhView& bvh = surface_.bvh();
  kernels::NearestFacet best{limit * limit, kNone};
  if (hint != kNone) {
    const double squared = kernels::distance_squared_to_facet(p, bvh.facets[hint]);
    if (squared < best.distance_squared) best = {squared, hint};
  }
  best = bvh.nearer_than(p, best);
  return {std::sqrt(best.distance_squared), best.facet};
}

Vec3d CellRegion::nearest_on(std::uint32_t facet, Vec3d p) const {
  return kernels::nearest_point_on_facet(p, surface_.bvh().facets[facet]).point;
}

}  // namespace aerate
