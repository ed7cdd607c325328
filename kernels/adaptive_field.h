#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "kernels/atomic.h"
#include "kernels/nearest_point.h"
#include "kernels/triangle_bvh.h"
#include "kernels/vec.h"
#include "kernels/view.h"
#include "kernels/winding.h"

// The clearance f(x) = min(distance to the surface - wall, min over placed balls of |x - c| - r - gap),
// negative outside the solid, that the adaptive packing places its balls by.

namespace aerate::kernels {

struct Ball {
  Vec3d centre;
  double radius;
};

inline constexpr std::uint32_t kNoBall = 0xffffffffu;
inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

struct NearestBall {
  double clearance;  // |p - c| - r - gap, or the limit if no ball is nearer
  std::uint32_t ball;
};

struct BallEntry {
  std::uint32_t ball;
  std::uint32_t next;
};

// Placed balls by the cells of a uniform grid. A ball is entered in every cell from which its clearance may
// be `reach` or less, so that one cell answers a query whatever the sizes of the balls; a cell that lies
// wholly in a ball names that ball alone. The grid is rebuilt with smaller cells as the largest clearance
// left shrinks.
struct BallGridView {
  static constexpr std::uint32_t kEmpty = 0xffffffffu;
  static constexpr std::uint32_t kInsideBit = 0x80000000u;

  Vec3d origin{0, 0, 0};
  double cell = 1;
  double cells_per_mm = 1;
  std::uint32_t count_x = 1, count_y = 1, count_z = 1;
  double reach = 0;
  double gap = 0;
  View<std::uint32_t> heads;  // by cell: kEmpty, first entry, or kInsideBit | ball
  View<BallEntry> entries;
  View<const Ball> balls;

  AERATE_HD std::uint32_t cell_x(double x) const {
    return ColumnGrid::cell_of(x - origin.x, cells_per_mm, count_x);
  }
  AERATE_HD std::uint32_t cell_y(double y) const {
    return ColumnGrid::cell_of(y - origin.y, cells_per_mm, count_y);
  }
  AERATE_HD std::uint32_t cell_z(double z) const {
    return ColumnGrid::cell_of(z - origin.z, cells_per_mm, count_z);
  }
  AERATE_HD std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (static_cast<std::size_t>(z) * count_y + y) * count_x + x;
  }

  // The ball of least clearance at p, if that is below min(limit, reach). Ties go to the smaller index.
  AERATE_HD NearestBall nearest(Vec3d p, double limit) const {
    NearestBall best{min_of(limit, reach), kNoBall};
    const std::uint32_t head = heads[index(cell_x(p.x), cell_y(p.y), cell_z(p.z))];
    if (head == kEmpty) return best;
    if ((head & kInsideBit) != 0) {
      const std::uint32_t ball = head & ~kInsideBit;
      return {length(p - balls[ball].centre) - balls[ball].radius - gap, ball};
    }
    for (std::uint32_t i = head; i != kEmpty; i = entries[i].next) {
      const std::uint32_t id = entries[i].ball;
      const Ball ball = balls[id];
      // Most balls of a cell are farther than the best so far, which squares can tell. The slack keeps the
      // rounding of squares out of the decision, which would otherwise depend on the order of the list.
      constexpr double kSlack = 1 + 1e-14;
      const double span = best.clearance + ball.radius + gap;
      const double distance_squared = length_squared(p - ball.centre);
      if (span < 0 || distance_squared > span * span * kSlack) continue;
      const double clearance = std::sqrt(distance_squared) - ball.radius - gap;
      if (clearance < best.clearance || (clearance == best.clearance && id < best.ball)) {
        best = {clearance, id};
      }
    }
    return best;
  }
};

namespace ball_grid_detail {

struct CellRange {
  std::uint32_t x0, x1, y0, y1, z0, z1;

  AERATE_HD CellRange(const BallGridView& grid, Vec3d centre, double radius)
      : x0(grid.cell_x(centre.x - radius)),
        x1(grid.cell_x(centre.x + radius)),
        y0(grid.cell_y(centre.y - radius)),
        y1(grid.cell_y(centre.y + radius)),
        z0(grid.cell_z(centre.z - radius)),
        z1(grid.cell_z(centre.z + radius)) {}
};

// Squared distances from a coordinate to the nearest and the farthest point of a cell along one axis.
struct AxisDistances {
  double nearest_squared, farthest_squared;

  AERATE_HD AxisDistances(double coordinate, double origin, double cell, std::uint32_t i) {
    const double below = coordinate - (origin + cell * i);
    const double above = cell - below;
    const double outside = max_of(max_of(-below, -above), 0.0);
    const double far = max_of(below, above);
    nearest_squared = outside * outside;
    farthest_squared = far * far;
  }
};

// A ball's layers of cells along z: the unit of work, so that a large ball is not one thread's.
struct CountLayers {
  BallGridView grid;
  std::uint32_t first_ball;
  View<std::uint32_t> layers;

  AERATE_HD void operator()(std::size_t i) const {
    const Ball ball = grid.balls[first_ball + i];
    const CellRange range(grid, ball.centre, ball.radius + grid.gap + grid.reach);
    layers[i] = range.z1 - range.z0 + 1;
  }
};

struct ListLayers {
  View<const std::uint32_t> offsets;
  View<const std::uint32_t> layers;
  View<std::uint32_t> layer_ball;
  View<std::uint32_t> layer_index;

  AERATE_HD void operator()(std::size_t i) const {
    for (std::uint32_t k = 0; k < layers[i]; ++k) {
      layer_ball[offsets[i] + k] = static_cast<std::uint32_t>(i);
      layer_index[offsets[i] + k] = k;
    }
  }
};

enum class EnterPass { mark_inside_and_count, link };

struct EnterLayer {
  BallGridView grid;
  std::uint32_t first_ball;
  View<const std::uint32_t> layer_ball;
  View<const std::uint32_t> layer_index;
  EnterPass pass;
  View<std::uint32_t> counts;         // by layer, written by the first pass
  View<const std::uint32_t> offsets;  // by layer, read by the second
  std::uint32_t first_entry;

  AERATE_HD void operator()(std::size_t layer) const {
    const std::uint32_t id = first_ball + layer_ball[layer];
    const Ball ball = grid.balls[id];
    const double outer = ball.radius + grid.gap + grid.reach;
    // Half the gap belongs to each ball: cells inside two balls at once cannot be.
    const double inner = ball.radius + 0.5 * grid.gap;
    const CellRange range(grid, ball.centre, outer);
    const std::uint32_t z = range.z0 + layer_index[layer];
    const AxisDistances dz(ball.centre.z, grid.origin.z, grid.cell, z);
    std::uint32_t entry = pass == EnterPass::link ? first_entry + offsets[layer] : 0;
    for (std::uint32_t y = range.y0; y <= range.y1; ++y) {
      const AxisDistances dy(ball.centre.y, grid.origin.y, grid.cell, y);
      for (std::uint32_t x = range.x0; x <= range.x1; ++x) {
        const AxisDistances dx(ball.centre.x, grid.origin.x, grid.cell, x);
        if (dx.nearest_squared + dy.nearest_squared + dz.nearest_squared > outer * outer) continue;
        const std::size_t cell = grid.index(x, y, z);
        const bool inside = dx.farthest_squared + dy.farthest_squared + dz.farthest_squared <= inner * inner;
        if (pass == EnterPass::mark_inside_and_count) {
          if (inside) {
            grid.heads[cell] = BallGridView::kInsideBit | id;
          } else {
            ++entry;
          }
        } else if (!inside) {
          // A slot is used up even where the cell lies in another ball: offsets must not depend on that.
          const std::uint32_t head = atomic_load(grid.heads[cell]);
          if (head == BallGridView::kEmpty || (head & BallGridView::kInsideBit) == 0) {
            grid.entries[entry].ball = id;
            grid.entries[entry].next = atomic_exchange(grid.heads[cell], entry);
          }
          ++entry;
        }
      }
    }
    if (pass == EnterPass::mark_inside_and_count) counts[layer] = entry;
  }
};

}  // namespace ball_grid_detail

// A value of f with what attains it, as a function that is easy to work with near p: |x - centre| - radius.
struct Clearance {
  double value;
  Vec3d centre;
  double radius;
};

struct FieldView {
  TriangleBvhView surface;
  WindingView winding;
  BallGridView balls;
  double wall = 0;
};

// Where the signed distance to the surface was last computed, and the facet that was nearest. The distance
// changes by no more than the way walked, so nearby points often need not ask again.
struct SurfaceAnchor {
  Vec3d point;
  double signed_distance;  // 0 if nothing is known
  std::uint32_t facet;     // may be kNoFacet
};

AERATE_HD inline bool is_inside(const FieldView& field, const SurfaceAnchor& anchor, Vec3d p) {
  const double walked_squared = length_squared(p - anchor.point);
  if (walked_squared < anchor.signed_distance * anchor.signed_distance * 0.999999) {
    return anchor.signed_distance > 0;
  }
  return field.winding.winding_number(p) == 1;
}

// The anchor at p, given one nearby.
AERATE_HD inline SurfaceAnchor anchor_at(const FieldView& field, const SurfaceAnchor& nearby, Vec3d p) {
  NearestFacet nearest{kUnbounded, nearby.facet};
  if (nearby.facet != kNoFacet) {
    nearest.distance_squared = distance_squared_to_facet(p, field.surface.facets[nearby.facet]);
  }
  nearest = field.surface.nearer_than(p, nearest);
  const double distance = std::sqrt(nearest.distance_squared);
  return {p, is_inside(field, nearby, p) ? distance : -distance, nearest.facet};
}

// The constraint that a facet is at p, which is at `signed_distance` from it.
AERATE_HD inline Clearance facet_clearance(const FieldView& field, std::uint32_t facet,
                                           double signed_distance, Vec3d p, double scale) {
  // A plane is a sphere of a large radius.
  constexpr double kPlaneRadii = 256;
  const FacetPoint foot = nearest_point_on_facet(p, field.surface.facets[facet]);
  Clearance result{signed_distance - field.wall, foot.point, field.wall};
  if (foot.feature == FacetFeature::rim && signed_distance > 0) return result;
  Vec3d gradient{0, 0, 0};
  if (signed_distance != 0) gradient = (p - foot.point) * (1.0 / signed_distance);
  const double radius = kPlaneRadii * max_of(std::abs(signed_distance), scale);
  result.centre = p - gradient * radius;
  result.radius = radius - result.value;
  return result;
}

// f(p) clipped to `limit` (where it is clipped, the sphere that comes with it means nothing) and what attains
// it; or, if f(p) < enough, anything that is below `enough` at p, with its value. What is cheap is asked
// first.
AERATE_HD inline Clearance clearance_at(const FieldView& field, SurfaceAnchor& anchor, Vec3d p, double limit,
                                        double enough) {
  const NearestBall ball = field.balls.nearest(p, limit);
  Clearance result{ball.clearance, p, 0};
  if (ball.ball != kNoBall) {
    const Ball& b = field.balls.balls[ball.ball];
    result.centre = b.centre;
    result.radius = b.radius + field.balls.gap;
    if (result.value < enough) return result;
  }
  const double walked = length(p - anchor.point);
  if (anchor.signed_distance - walked - field.wall >= result.value) return result;

  const bool inside = is_inside(field, anchor, p);
  NearestFacet nearest{kUnbounded, anchor.facet};
  if (anchor.facet != kNoFacet) {
    nearest.distance_squared = distance_squared_to_facet(p, field.surface.facets[anchor.facet]);
    if (inside) {
      const double distance = std::sqrt(nearest.distance_squared);
      if (distance - field.wall < min_of(enough, result.value)) {
        return facet_clearance(field, anchor.facet, distance, p, limit);
      }
    }
  }
  const double search = result.value + field.wall;
  if (inside && nearest.distance_squared > search * search) nearest = {search * search, kNoFacet};
  nearest = field.surface.nearer_than(p, nearest);
  if (nearest.facet == kNoFacet) return result;
  const double distance = std::sqrt(nearest.distance_squared);
  anchor = {p, inside ? distance : -distance, nearest.facet};
  if (anchor.signed_distance - field.wall >= result.value) return result;
  return facet_clearance(field, anchor.facet, anchor.signed_distance, p, limit);
}

}  // namespace aerate::kernels
