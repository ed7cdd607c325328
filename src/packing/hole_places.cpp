#include "packing/hole_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tbb/parallel_for.h>

#include "kernels/constants.h"
#include "packing/hole_rules.h"
#include "packing/placed_tubes.h"
#include "packing/pools.h"
#include "packing/tube_through.h"

namespace aerate {
namespace {

// Voids that are looked at for one hole.
constexpr std::size_t kMostVoids = 48;

// Places of the axis in each direction.
constexpr std::size_t kPoints = 3;

// A void is roomy if the distance of its centre from the hole's rim is at least this share of that between
// the axes of the hole and of a channel: the two then open into it at 113 degrees from each other or less.
constexpr double kRoomyShare = 0.6;

}  // namespace

HolePlaces::HolePlaces(const DrainableModel& model, std::span<const VoidShape> voids,
                       const PackingLimits& limits, const DrainageRequest& request,
                       const TubeClearance& clearance)
    : voids_(voids),
      limits_(limits),
      request_(request),
      clearance_(clearance),
      outward_(model.outward),
      showing_(clearance, limits.roof.up, model.plate, request) {}

// Ends the tube where its axis meets the surface.
bool HolePlaces::reach_surface(EscapeHole& hole) const {
  const Vec3d axis = direction_of(hole.tube);
  const auto hit = clearance_.first_hit(hole.tube.start, axis, longest_hole(request_, limits_));
  if (hit) hole.tube.end = hole.tube.start + axis * *hit;
  return hit.has_value();
}

bool HolePlaces::is_sound(const EscapeHole& hole) {
  const Vec3d start = hole.tube.start, end = hole.tube.end;
  const auto [known, is_new] = sound_.try_emplace(
      {static_cast<double>(hole.from), start.x, start.y, start.z, end.x, end.y, end.z}, false);
  if (is_new) known->second = look_whether_sound(hole);
  return known->second;
}

bool HolePlaces::look_whether_sound(const EscapeHole& hole) const {
  const Tube& tube = hole.tube;
  return leads_outside(tube, limits_.wall, clearance_, outward_) &&
         clearance_.keeps_gap_to_voids(tube, hole.from, hole.from) &&
         clearance_.keeps_wall_on_way_out(tube, kLeastSlope);
}

// The tube from a void through a point inside it, a millimetre long: nullopt if it may not open there.
std::optional<Tube> HolePlaces::tube_from(const VoidShape& shape, Vec3d inside, Vec3d direction) const {
  auto tube = tube_out_of(shape, inside, direction, 1, request_.hole_radius);
  if (tube && (!shape.opens_below_roof(*tube, TubeEnd::start) || !is_bridged(*tube, limits_.roof)))
    tube.reset();
  return tube;
}

// A point of the axis of a tube that leaves a void in this direction: through the centre, or halfway or all
// the way to where its side would graze the ball, lowered in the sense of `down`. Under a roof it is measured
// from the highest that leaves the ball below it. nullopt if that is the same as the one before.
std::optional<Vec3d> HolePlaces::start_inside(const VoidShape& shape, Vec3d direction, Vec3d down,
                                              std::size_t point) const {
  // A trifle less than the widest, so that rounding does not matter.
  const double farthest = (kWidestTubeShare * shape.radius() - request_.hole_radius) * (1 - 1e-9);
  const double share = static_cast<double>(point) / (kPoints - 1);
  if (shape.has_roof() && dot(down, limits_.roof.up) > 0) {
    const auto way = shape.way_below_roof(direction, request_.hole_radius);
    if (!way) return std::nullopt;
    const double highest = std::min(way->highest, 0.0);
    if (highest < -farthest || (highest == -farthest && point > 0)) return std::nullopt;
    return shape.centre() + way->across * (highest - share * (highest + farthest));
  }
  if (farthest * share == 0 && point > 0) return std::nullopt;
  // Lowered so far that the tube's axis passes the centre at that distance.
  const double across = std::sqrt(std::max(1e-6, 1 - dot(direction, down) * dot(direction, down)));
  return shape.centre() + down * std::min(farthest * share / across, shape.radius() * 0.99);
}

HolePlaces::Ranking::Ranking(const HolePlaces& places, std::span<Place* const> candidates, Vec3d down,
                             double lowest, double height)
    : places_(places), down_(down), lowest_(lowest), height_(height) {
  for (std::size_t i = 0; i < candidates.size(); ++i) push(i, *candidates[i]);
}

double HolePlaces::Ranking::cost_of(const Place& place) const {
  return place.sill - lowest_ + places_.request_.worth_of_hiding * height_ * place.showing +
         kLengthWeight * place.length;
}

void HolePlaces::Ranking::push(std::size_t number, Place& place) {
  const double cost = cost_of(place);
  if (cost < kInfinity) queue_.push({cost, number, &place});
}

std::optional<EscapeHole> HolePlaces::Ranking::next() {
  while (!queue_.empty()) {
    const Candidate best = queue_.top();
    queue_.pop();
    places_.look_at(*best.place, down_);
    if (cost_of(*best.place) <= best.cost) return best.place->hole;
    push(best.number, *best.place);
  }
  return std::nullopt;
}

HolePlaces::Ranking HolePlaces::ranked(std::span<const std::uint32_t> voids, Vec3d down, double share) {
  const Vec3d up = -down;
  const auto bottom_of = [&](std::uint32_t i) { return voids_[i].bottom(up); };
  double lowest = kInfinity;
  double highest = -lowest;
  std::vector<std::uint32_t> wide;
  for (const std::uint32_t i : voids) {
    lowest = std::min(lowest, bottom_of(i));
    highest = std::max(highest, -voids_[i].bottom(down));
    if (voids_[i].takes_tube(request_.hole_radius)) wide.push_back(i);
  }
  // Beside a hole in a small void there is no room for a channel.
  const auto is_roomy = [&](std::uint32_t i) {
    const double hole = request_.hole_radius, radius = voids_[i].radius();
    const double to_rim = std::sqrt(std::max(0.0, radius * radius - hole * hole));
    return to_rim >= kRoomyShare * tube_spacing(hole, request_.channel_radius);
  };
  if (std::any_of(wide.begin(), wide.end(), is_roomy))
    std::erase_if(wide, [&](std::uint32_t i) { return !is_roomy(i); });
  std::stable_sort(wide.begin(), wide.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return bottom_of(a) < bottom_of(b); });
  if (wide.size() > kMostVoids) wide.resize(kMostVoids);
  const double height = highest - lowest;
  while (wide.size() > 4 && bottom_of(wide.back()) > lowest + share * height) wide.pop_back();

  find_places(wide, down);
  std::vector<Place*> candidates;
  for (const std::uint32_t i : wide) {
    for (Place& place : *places_of(down)[i]) candidates.push_back(&place);
  }
  return {*this, candidates, down, lowest, height};
}

HolePlaces::PlacesByVoid& HolePlaces::places_of(Vec3d down) {
  return places_[dot(down, limits_.roof.up) > 0 ? 1 : 0];
}

// Finds the places of those voids for which that was not done.
void HolePlaces::find_places(std::span<const std::uint32_t> voids, Vec3d down) {
  PlacesByVoid& places = places_of(down);
  places.resize(voids_.size());
  std::vector<Vec3d> directions = directions_about(down);
  // Below a roof few tubes lead upwards: one from high up that leads down is still a high one.
  if (limits_.roof.limits_ceilings() && dot(down, limits_.roof.up) > 0) {
    const std::vector<Vec3d> back = directions_about(-down);
    directions.insert(directions.end(), back.begin(), back.end());
  }
  tbb::parallel_for(std::size_t{0}, voids.size(), [&](std::size_t i) {
    std::optional<std::vector<Place>>& own = places[voids[i]];
    if (own) return;
    own.emplace();
    for (const Vec3d direction : directions) {
      for (std::size_t point = 0; point < kPoints; ++point) {
        const auto place = place_of(voids[i], direction, down, point);
        if (place) own->push_back(*place);
      }
    }
  });
}

std::optional<HolePlaces::Place> HolePlaces::place_of(std::uint32_t from, Vec3d direction, Vec3d down,
                                                      std::size_t point) const {
  const VoidShape& shape = voids_[from];
  const auto inside = start_inside(shape, direction, down, point);
  if (!inside) return std::nullopt;
  const auto tube = tube_from(shape, *inside, direction);
  if (!tube) return std::nullopt;
  return Place{.hole = {from, *tube, 0},
               .sill = shape.opening_floor(*tube, TubeEnd::start, -down),
               .length = limits_.wall};
}

// Follows the tube to the surface.
void HolePlaces::look_at(Place& place, Vec3d down) const {
  if (place.is_looked_at) return;
  place.is_looked_at = true;
  const Tube& tube = place.hole.tube;
  if (reach_surface(place.hole) && showing_.is_allowed(tube)) {
    place.sill = sill_of_hole(place.hole, voids_[place.hole.from], -down);
    place.showing = showing_.of(tube);
    place.length = length(tube.end - tube.start);
  } else {
    place.sill = kInfinity;
  }
}

std::vector<EscapeHole> HolePlaces::leading_to(Vec3d place, std::span<const std::uint32_t> voids) const {
  const Vec3d on_surface = on_surface_near(place, 2 * request_.hole_radius, clearance_, outward_);
  std::vector<EscapeHole> holes;
  if (!clearance_.keeps_off_kept({on_surface, on_surface, request_.hole_radius})) return holes;
  for (const std::uint32_t from : voids) {
    const VoidShape& shape = voids_[from];
    constexpr int kDistances = 4;
    for (int i = 0; i < 1 + 6 * kDistances; ++i) {
      // The centre, and points around it along the axes.
      const int distance_index = (i + 5) / 6;
      const double shift = shape.radius() * 0.85 * distance_index / kDistances;
      constexpr std::array<Vec3d, 6> kAxes{Vec3d{0, 0, -1}, Vec3d{0, 0, 1}, Vec3d{1, 0, 0},
                                           Vec3d{-1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, -1, 0}};
      const Vec3d inside = shape.centre() + kAxes[static_cast<std::size_t>((i + 5) % 6)] * shift;
      const double distance = length(on_surface - inside);
      if (distance <= shape.radius()) continue;
      const auto tube = tube_from(shape, inside, (on_surface - inside) * (1 / distance));
      if (!tube) continue;
      EscapeHole hole{from, *tube, 0};
      if (reach_surface(hole) && length(hole.tube.end - on_surface) < request_.hole_radius)
        holes.push_back(hole);
    }
  }
  std::stable_sort(holes.begin(), holes.end(), [](const EscapeHole& a, const EscapeHole& b) {
    return length_squared(a.tube.end - a.tube.start) < length_squared(b.tube.end - b.tube.start);
  });
  return holes;
}

}  // namespace aerate
