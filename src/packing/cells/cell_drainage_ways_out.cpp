#include "packing/cells/cell_drainage_ways_out.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "kernels/constants.h"
#include "packing/hole_rules.h"

namespace aerate {
namespace {

// The tube starts so far before its side leaves the void, mm, and its two rims are as far apart along it.
constexpr double kClearance = 0.25;

}  // namespace

double lean_of(Vec3d direction, Vec3d up) {
  const double rise = dot(direction, up);
  return std::sqrt(std::max(0.0, 1 - rise * rise));
}

WaysOut::WaysOut(const std::vector<VoidHollows>& hollows, const PackingLimits& limits, double radius,
                 const CellSurfaces& surfaces, const kernels::WindingView& outward)
    : hollows_(hollows),
      limits_(limits),
      radius_(radius),
      longest_(longest_hole({.channel_radius = radius, .hole_radius = radius, .escape_holes = {}}, limits)),
      surfaces_(surfaces),
      outward_(outward) {}

// False if part of the tube's side does not begin in the void, leaves it too obliquely, or leaves the tube too long or too
// short.
bool WaysOut::leave_void(const Tube& tube, CellWayOut& way) const {
  const Vec3d axis = direction_of(tube), up = limits_.roof.up;
  // The axis first: where it fails, as most do, no line of the side is looked at.
  std::vector<Vec3d> starts{tube.start};
  starts.reserve(1 + kTubeSides);
  std::ranges::copy(lines_round(tube.start, tube, up), std::back_inserter(starts));
  way.first = way.lowest = kInfinity;
  way.last = way.highest = -kInfinity;
  for (const Vec3d start : starts) {
    const auto hit = surfaces_.voids().first_hit_with_normal(start, axis, 2 * longest_);
    if (!hit || dot(hit->normal, axis) > -kLeastSlope) return false;
    const Vec3d at = start + axis * hit->along;
    way.first = std::min(way.first, hit->along);
    way.last = std::max(way.last, hit->along);
    way.lowest = std::min(way.lowest, dot(at, up));
    way.highest = std::max(way.highest, dot(at, up));
    if (way.last + kClearance > way.reached || way.length() > longest_) return false;
  }
  return true;
}

std::optional<CellWayOut> WaysOut::follow(std::uint32_t from, Vec3d inside, Vec3d direction) const {
  const auto reached = surfaces_.model().first_hit_with_normal(inside, direction, 2 * longest_);
  if (!reached || dot(reached->normal, direction) < kLeastSlope) return std::nullopt;
  CellWayOut way{.hole = {from, {inside, inside + direction * reached->along, radius_}, 0},
                 .reached = reached->along};
  Tube& tube = way.hole.tube;
  if (!leave_void(tube, way)) return std::nullopt;
  const double skipped = std::max(0.0, way.first - kClearance);
  tube.start = inside + direction * skipped;
  way.first -= skipped;
  way.last -= skipped;
  way.reached -= skipped;
  return way;
}

bool WaysOut::is_sound(const CellWayOut& way) const {
  const Tube& tube = way.hole.tube;
  const Vec3d axis = direction_of(tube);
  if (!leads_outside(tube, limits_.wall, surfaces_.model(), outward_)) return false;
  double first_out = kInfinity;
  for (const Vec3d start : lines_round(tube.start, tube, limits_.roof.up)) {
    const auto out = surfaces_.model().first_hit_with_normal(start, axis, 2 * longest_);
    if (!out || dot(out->normal, axis) < kLeastSlope) return false;
    first_out = std::min(first_out, out->along);
    // No void again beyond where it left its own.
    const auto left = surfaces_.voids().first_hit(start, axis, 2 * longest_);
    const Vec3d beyond = start + axis * (left.value_or(0) + 1e-4);
    if (!left || surfaces_.voids().is_hit(beyond, axis, std::max(0.0, out->along - *left))) return false;
  }
  if (first_out < way.last + kClearance) return false;
  const Tube outside{tube.start + axis * way.first, tube.end, radius_};
  return surfaces_.keeps_gap(tube, way.hole.from, way.hole.from) &&
         surfaces_.model().keeps_wall_on_way_out(outside, kLeastSlope);
}

double WaysOut::sill_of(const CellWayOut& way, std::size_t orientation) const {
  const Vec3d up = orientation == kUpright ? limits_.roof.up : -limits_.roof.up;
  const double inside = orientation == kUpright ? way.lowest : -way.highest;
  const double outside = dot(way.hole.tube.end, up) - radius_ * lean_of(direction_of(way.hole.tube), up);
  return std::max(inside, outside);
}

CellHole WaysOut::hole_of(const CellWayOut& way) const {
  CellHole result{.hole = way.hole, .passage = {}};
  const Tube& tube = way.hole.tube;
  const VoidHollows& hollows = hollows_[way.hole.from];
  const double depth = 1.5 * hollows.nodes().lattice.spacing;
  const Vec3d axis = direction_of(tube);
  const Segment leaving{tube.start + axis * (way.first - depth), tube.start + axis * way.last};
  result.passage.mouths[0].into = way.hole.from;
  for (const std::size_t orientation : {kUpright, kUpsideDown}) {
    const double sill = sill_of(way, orientation);
    result.passage.sill[orientation] = sill;
    result.passage.mouths[0].hollows[orientation] = hollows.hollows_near(leaving, radius_, sill, orientation);
  }
  return result;
}

}  // namespace aerate
