#pragma once

#include "kernels/vec.h"
#include "printing/cells/cell_region.h"
#include "printing/cells/rolled_balls.h"

namespace aerate {

// A point of a void's surface, and the centre of a ball in the region that it lies on: towards there the point
// may be moved, and stays in the void.
struct PlacedVertex {
  Vec3d at{0, 0, 0};
  Vec3d inward{0, 0, 0};
};

// Moves points that lie near the surface of an opened region onto it: the point is looked at from the nearest
// place at which the centre of a ball of the radius may be, and lies as far from there as the region is deep.
// So it is in the region, exactly, whatever was known of the place before.
class SurfacePlacer {
 public:
  // `margin`: how far inside points are placed, for rounding, mm.
  SurfacePlacer(const CellRegion& region, double ball_radius, double spacing, double margin)
      : region_(region), radius_(ball_radius), spacing_(spacing), margin_(margin) {}

  // `near`: the ball that covers the void beside the point; `is_crease`: another one, far from it, does so as
  // well, and the surface has a crease between the two that no ball's centre tells.
  PlacedVertex place(Vec3d point, const RolledBall& near, bool is_crease) const;

 private:
  PlacedVertex from_centre(Vec3d point, Vec3d centre, double depth) const;
  PlacedVertex at_crease(Vec3d point, const RolledBall& near) const;
  double depth_at(Vec3d p, const RolledBall& near) const;

  const CellRegion& region_;
  double radius_, spacing_, margin_;
};

}  // namespace aerate
