#pragma once

#include <cstdint>
#include <span>

#include "core/surface_index.h"
#include "kernels/cell_planes.h"
#include "kernels/constants.h"
#include "kernels/vec.h"
#include "printing/cells/near_facets.h"

namespace aerate {

// How far a point is from a model's surface, if nearer than some limit.
struct SurfaceNearby {
  double distance = 0;          // or the limit
  std::uint32_t facet = kNone;  // in the hierarchy's order; kNone if the surface is not nearer than the limit
};

// Where the void of one cell may be: behind the cell's planes, and deeper than the wall where the winding number
// is 1. Both depths change by no more than the way between two points, and so does the lesser of them: a ball
// about a point as large as the point is deep lies wholly within. Exact, fp64.
class CellRegion {
 public:
  // `near` is of the surface's facets.
  CellRegion(std::span<const CellPlane> planes, const SurfaceIndex& surface, const NearFacets& near,
             double wall)
      : planes_(planes), surface_(surface), near_(near), wall_(wall) {}

  std::span<const CellPlane> planes() const { return planes_; }
  double wall() const { return wall_; }

  double behind_planes(Vec3d p) const {
    double least = kInfinity;
    for (const CellPlane& plane : planes_) {
      const double depth = plane.offset - dot(plane.normal, p);
      least = depth < least ? depth : least;
    }
    return least;
  }

  // `hint`: a facet that may be near, or kNone.
  SurfaceNearby surface_near(Vec3d p, double limit, std::uint32_t hint) const;
  Vec3d nearest_on(std::uint32_t facet, Vec3d p) const;
  bool is_inside(Vec3d p) const { return surface_.winding().winding_number(p) == 1; }
  const NearFacets& near_facets() const { return near_; }

 private:
  std::span<const CellPlane> planes_;
  const SurfaceIndex& surface_;
  const NearFacets& near_;
  double wall_;
};

}  // namespace aerate
