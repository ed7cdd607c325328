#include "printing/cells/surface_placer.h"

#include <algorithm>
#include <cmath>

#include "printing/cells/nearest_in_halfspaces.h"

namespace aerate {
namespace {

// Depths that differ by less are the same, mm.
constexpr double kSame = 1e-6;

}  // namespace

double SurfacePlacer::depth_at(Vec3d p, const RolledBall& near) const {
  const double behind = region_.behind_planes(p);
  if (!near.is_near_surface) return behind;
  const SurfaceNearby surface = region_.surface_near(p, region_.wall() + 2 * radius_, near.facet);
  return std::min(behind, surface.distance - region_.wall());
}

PlacedVertex SurfacePlacer::from_centre(Vec3d point, Vec3d centre, double depth) const {
  const Vec3d way = point - centre;
  const double distance = length(way);
  if (distance < kSame) return {centre, centre};
  return {centre + way * (std::max(0.0, depth - margin_) / distance), centre};
}

// Where the point is, if that is in the region, else on the ball.
PlacedVertex SurfacePlacer::at_crease(Vec3d point, const RolledBall& near) const {
  if (depth_at(point, near) > margin_) return {point, near.centre};
  return from_centre(point, near.centre, near.radius);
}

PlacedVertex SurfacePlacer::place(Vec3d point, const RolledBall& near, bool is_crease) const {
  if (is_crease) return at_crease(point, near);
  const double needed = region_.wall() + radius_;
  // One plane alone.
  const CellPlane* nearest = nullptr;
  double behind = kInfinity;
  for (const CellPlane& plane : region_.planes()) {
    const double depth = plane.offset - dot(plane.normal, point);
    if (depth >= behind) continue;
    behind = depth;
    nearest = &plane;
  }
  std::uint32_t hint = near.facet;
  // No vertex is moved far: where another piece of the cell is near, the void ends within the region.
  if (nearest != nullptr && std::abs(behind) < spacing_) {
    const Vec3d centre = point - nearest->normal * (radius_ - behind);
    if (region_.behind_planes(centre) >= radius_ - kSame) {
      const bool is_clear = !near.is_near_surface ||
                            region_.surface_near(centre, needed, hint).distance >= needed - kSame * 1e-3;
      if (is_clear) return {centre + nearest->normal * (radius_ - margin_), centre};
    }
  }
  Halfspaces bounds;
  for (const CellPlane& plane : region_.planes()) {
    if (plane.offset - dot(plane.normal, point) < 2 * radius_ + spacing_)
      bounds.add(plane.normal, plane.offset - radius_);
  }
  // The surface's offset is what planes at right angles to the way to it leave, one after the other.
  const auto keep_away = [&](Vec3d from, std::uint32_t facet) {
    const Vec3d foot = region_.nearest_on(facet, from);
    const Vec3d away = normalised(from - foot);
    bounds.add(-away, -(dot(away, foot) + needed));
  };
  if (near.is_near_surface) {
    const SurfaceNearby surface = region_.surface_near(point, needed, hint);
    if (surface.facet != kNone && surface.distance > kSame) {
      hint = surface.facet;
      // The surface alone.
      const Vec3d foot = region_.nearest_on(hint, point);
      const Vec3d away = normalised(point - foot);
      const Vec3d centre = foot + away * needed;
      if (std::abs(surface.distance - region_.wall()) < spacing_ &&
          region_.behind_planes(centre) >= radius_ &&
          region_.surface_near(centre, needed, hint).distance >= needed - kSame)
        return {centre - away * (radius_ - kSame - margin_), centre};
      keep_away(point, hint);
    }
  }
  constexpr int kMostRounds = 6;
  Vec3d centre = point;
  double below = kInfinity;
  for (int round = 0; round < kMostRounds; ++round) {
    centre = bounds.nearest_to(point);
    if (!near.is_near_surface) break;
    const SurfaceNearby surface = region_.surface_near(centre, needed + radius_, hint);
    below = surface.distance - region_.wall();
    if (surface.facet == kNone || surface.distance >= needed - kSame || surface.distance < kSame) break;
    hint = surface.facet;
    keep_away(centre, hint);
  }
  // Where the region is as narrow as the ball, what was sampled may differ from what is there.
  constexpr double kLeastDepth = 0.7;
  const double depth = std::min(region_.behind_planes(centre), below);
  if (depth < kLeastDepth * radius_ || length(centre - near.centre) > 3 * radius_)
    return at_crease(point, near);
  const PlacedVertex placed = from_centre(point, centre, depth);
  return length(placed.at - point) > spacing_ ? at_crease(point, near) : placed;
}

}  // namespace aerate
