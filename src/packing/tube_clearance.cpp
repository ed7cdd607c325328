#include "packing/tube_clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "kernels/constants.h"
#include "kernels/nearest_point.h"
#include "packing/sphere_pairs.h"

namespace aerate {
namespace {

// A point this near to the surface is on it, mm: the facet there is found at once.
constexpr double kOnSurface = 1e-6;

// Of unit length; 0 if the facet has no area.
Vec3d normal_of(const kernels::Facet& facet) {
  const Vec3d a = to_double(facet.a);
  const Vec3d normal = cross(to_double(facet.b) - a, to_double(facet.c) - a);
  const double size = length(normal);
  return size > 0 ? normal * (1 / size) : Vec3d{0, 0, 0};
}

}  // namespace

TubeClearance::TubeClearance(const SurfaceIndex& surface, const Packing& packing, double longest,
                             double widest_radius, const SurfaceIndex* kept)
    : bvh_(surface.bvh()),
      rays_(surface.bvh()),
      kept_(kept),
      voids_(shapes_of(packing.spheres, packing.limits.roof)),
      limits_(packing.limits),
      longest_(longest) {
  for (const VoidShape& shape : voids_) roofs_ = std::max(roofs_, shape.reach_beyond_ball());
  const double reach = longest + widest_radius + limits_.gap + roofs_;
  neighbours_.resize(voids_.size());
  for (const SpherePair& pair : find_pairs_within(packing.spheres, reach)) {
    neighbours_[pair.first].push_back({pair.gap, pair.second});
    neighbours_[pair.second].push_back({pair.gap, pair.first});
  }
  for (std::vector<Neighbour>& neighbours : neighbours_)
    std::sort(neighbours.begin(), neighbours.end(), [](const Neighbour& a, const Neighbour& b) {
      return std::tie(a.gap, a.index) < std::tie(b.gap, b.index);
    });
}

std::span<const TubeClearance::Neighbour> TubeClearance::neighbours(std::uint32_t at) const {
  const std::vector<Neighbour>& all = neighbours_[at];
  const auto end =
      std::find_if(all.begin(), all.end(), [&](const Neighbour& n) { return n.gap >= longest_; });
  return {all.begin(), end};
}

double TubeClearance::to_surface(Vec3d point, double limit) const {
  return std::sqrt(bvh_.nearest(point, limit * limit).distance_squared);
}

std::optional<double> TubeClearance::first_hit(Vec3d start, Vec3d direction, double longest) const {
  const auto hit = rays_.first_hit(start, direction, longest);
  return hit ? std::optional(hit->along) : std::nullopt;
}

std::optional<TubeClearance::Hit> TubeClearance::first_hit_with_normal(Vec3d start, Vec3d direction,
                                                                       double longest) const {
  const auto hit = rays_.first_hit(start, direction, longest);
  if (!hit) return std::nullopt;
  return Hit{hit->along, normal_of(bvh_.facets[hit->facet])};
}

bool TubeClearance::is_hit(Vec3d start, Vec3d direction, double longest) const {
  return rays_.is_hit(start, direction, longest);
}

Vec3d TubeClearance::nearest_on_surface(Vec3d point) const {
  const kernels::NearestFacet nearest = bvh_.nearest(point, kInfinity);
  return kernels::nearest_point_on_facet(point, bvh_.facets[nearest.facet]).point;
}

Vec3d TubeClearance::normal_near(Vec3d point) const {
  kernels::NearestFacet nearest = bvh_.nearest(point, kOnSurface * kOnSurface);
  if (nearest.facet == kNone) nearest = bvh_.nearest(point, kInfinity);
  return normal_of(bvh_.facets[nearest.facet]);
}

bool TubeClearance::keeps_wall(const Tube& tube) const {
  return keeps_off_kept(tube) && keeps_away(tube, tube.radius + limits_.wall, kInfinity);
}

bool TubeClearance::keeps_wall_on_way_out(const Tube& tube, double slope) const {
  const Tube cut{tube.start, tube.end + direction_of(tube) * (kCutBeyond * tube.radius), tube.radius};
  return keeps_off_kept(cut) && keeps_away(tube, tube.radius + limits_.wall, slope);
}

bool TubeClearance::keeps_off_kept(const Tube& tube) const {
  return kept_ == nullptr ||
         kept_->triangles_near({tube.start, tube.end}, tube.radius + limits_.wall).empty();
}

bool TubeClearance::keeps_away(const Tube& tube, double most, double slope) const {
  const bool comes_out = slope < kInfinity;
  const double whole = length(tube.end - tube.start);
  // What is asked of a point at this way from the end.
  const auto needed = [&](double left) { return comes_out ? std::min(most, slope * left) : most; };
  // Where the surface is oblique and near, only short pieces are shown clear.
  const double shortest = comes_out ? kWallSlack / 32 : kWallSlack / 2;
  // Pieces of the axis still to be shown clear, as shares of it.
  std::vector<std::pair<double, double>> open{{0.0, 1.0}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    if (comes_out && (1 - from) * whole <= kWallSlack) continue;
    const double middle = (from + to) / 2;
    const double half = (to - from) / 2 * whole;
    const double everywhere = needed((1 - from) * whole) + half;
    const double distance =
        to_surface(tube.start + (tube.end - tube.start) * middle, everywhere * (1 + 1e-9));
    if (distance >= everywhere) continue;
    if (distance < needed((1 - middle) * whole) || half < shortest) return false;
    open.push_back({from, middle});
    open.push_back({middle, to});
  }
  return true;
}

bool TubeClearance::keeps_gap_to_voids(const Tube& tube, std::uint32_t from, std::uint32_t to) const {
  const double needed = tube.radius + limits_.gap;
  const double reach = length(tube.end - tube.start) + needed + roofs_;
  for (const auto& [gap, other] : neighbours_[from]) {
    if (gap > reach) break;
    if (other != to && !voids_[other].is_farther_than(needed, {tube.start, tube.end})) return false;
  }
  return true;
}

}  // namespace aerate
