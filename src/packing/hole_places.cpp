#include "packing/hole_places.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "packing/pools.h"
#include "packing/tube_through.h"

namespace aerate {
namespace {

// The longest hole, in its diameters and walls together.
constexpr double kLongestInDiameters = 3;
constexpr double kLongestInWalls = 3;

// Balls that are looked at for one hole, and directions from each.
constexpr std::size_t kMostBalls = 48;
constexpr int kDirections = 64;

// A ball is roomy if the distance of its centre from the hole's rim is at least this share of that between
// the axes of the hole and of a channel: the two then open into it at 113 degrees from each other or less.
constexpr double kRoomyShare = 0.6;

// Weights of what makes a place good, in heights of the network: a tenth of it is given for a place that does
// not show.
constexpr double kShowingWeight = 0.1;
constexpr double kLengthWeight = 0.2;  // a millimetre of tube for each millimetre of height

// Near its outer end a tube is nearer to the surface than the wall. It comes up to it no flatter than this:
// the sine of 30 degrees.
constexpr double kLeastSlope = 0.5;

constexpr double kOnSurface = 1e-4;  // mm

Vec3d normalised(Vec3d v) {
  return v * (1 / length(v));
}

// Points spread evenly over the half of the unit sphere about `axis`, which is the first of them.
std::vector<Vec3d> directions_about(Vec3d axis) {
  const TubeFrame frame = frame_of({{0, 0, 0}, axis, 1}, {0, 0, 1});
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<Vec3d> directions{axis};
  for (int i = 0; i < kDirections; ++i) {
    const double along = 1 - (i + 0.5) / kDirections;
    const double across = std::sqrt(1 - along * along);
    directions.push_back(axis * along +
                         (frame.down * std::cos(golden * i) + frame.across * std::sin(golden * i)) * across);
  }
  return directions;
}

std::string to_text(Vec3d p) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << '(' << p.x << ", " << p.y << ", " << p.z << ") mm";
  return text.str();
}

}  // namespace

double longest_hole(const DrainageRequest& request, const PackingLimits& limits) {
  return kLongestInDiameters * 2 * request.hole_radius + kLongestInWalls * limits.wall;
}

HolePlaces::HolePlaces(std::span<const Triangle> outward_shells, const Mesh& mesh,
                       std::span<const Sphere> spheres, const PackingLimits& limits,
                       const DrainageRequest& request, const TubeClearance& clearance)
    : spheres_(spheres),
      limits_(limits),
      request_(request),
      clearance_(clearance),
      outward_(mesh.positions, outward_shells) {}

// Follows the axis from the tube's start to the surface, by as much as is free at each point.
bool HolePlaces::reach_surface(EscapeHole& hole) const {
  const Vec3d axis = normalised(hole.tube.end - hole.tube.start);
  const double longest = longest_hole(request_, limits_);
  double along = 0;
  constexpr int kMostSteps = 200;
  for (int step = 0; step < kMostSteps && along <= longest; ++step) {
    const double free = clearance_.to_surface(hole.tube.start + axis * along, longest);
    if (free < kOnSurface) {
      hole.tube.end = hole.tube.start + axis * along;
      return along > 0;
    }
    along += free;
  }
  return false;
}

double HolePlaces::showing(Vec3d place) const {
  const Vec3d up = request_.up;
  const Vec3d side = std::abs(up.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d back = normalised(cross(up, side));
  const Vec3d normal = clearance_.normal_near(place);
  return 0.3 * (1 + dot(normal, up)) + 0.2 * (1 - dot(normal, back));
}

bool HolePlaces::is_sound(const EscapeHole& hole) const {
  const Tube& tube = hole.tube;
  const Vec3d axis = normalised(tube.end - tube.start);
  const double needed = tube.radius + limits_.wall;
  if (!clearance_.keeps_wall_on_way_out(tube, kLeastSlope)) return false;
  // Outside there has to be room, as wide as the hole.
  for (const double beyond : {tube.radius, 2 * tube.radius}) {
    const Vec3d p = tube.end + axis * beyond;
    if (outward_.view().winding_number(p) != 0) return false;
    if (clearance_.to_surface(p, needed) < kLeastSlope * beyond / 2) return false;
  }
  return clearance_.keeps_gap_to_voids(tube, hole.from, hole.from) &&
         clearance_.keeps_gap_to_tubes(tube, hole.from, hole.from);
}

std::vector<EscapeHole> HolePlaces::ranked(std::span<const std::uint32_t> balls, Vec3d down,
                                           double share) const {
  const Vec3d up = -down;
  const auto bottom_of = [&](std::uint32_t i) { return dot(spheres_[i].centre, up) - spheres_[i].radius; };
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  std::vector<std::uint32_t> wide;
  for (const std::uint32_t i : balls) {
    lowest = std::min(lowest, bottom_of(i));
    highest = std::max(highest, dot(spheres_[i].centre, up) + spheres_[i].radius);
    if (request_.hole_radius <= kWidestTubeShare * spheres_[i].radius) wide.push_back(i);
  }
  // Beside a hole in a small ball there is no room for a channel.
  const auto is_roomy = [&](std::uint32_t i) {
    const double hole = request_.hole_radius, radius = spheres_[i].radius;
    const double to_rim = std::sqrt(std::max(0.0, radius * radius - hole * hole));
    return to_rim >= kRoomyShare * tube_spacing(hole, request_.channel_radius);
  };
  if (std::any_of(wide.begin(), wide.end(), is_roomy))
    std::erase_if(wide, [&](std::uint32_t i) { return !is_roomy(i); });
  std::stable_sort(wide.begin(), wide.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return bottom_of(a) < bottom_of(b); });
  if (wide.size() > kMostBalls) wide.resize(kMostBalls);
  const double height = highest - lowest;
  while (wide.size() > 4 && bottom_of(wide.back()) > lowest + share * height) wide.pop_back();

  const std::vector<Vec3d> directions = directions_about(down);
  constexpr std::size_t kPoints = 3;
  struct Place {
    double cost = std::numeric_limits<double>::infinity();
    EscapeHole hole;
  };
  std::vector<Place> places(wide.size() * directions.size() * kPoints);
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    const std::uint32_t from = wide[i / (directions.size() * kPoints)];
    const Vec3d direction = directions[i / kPoints % directions.size()];
    const Sphere& ball = spheres_[from];
    const double lower = (kWidestTubeShare * ball.radius - request_.hole_radius) *
                         static_cast<double>(i % kPoints) / (kPoints - 1);
    if (lower == 0 && i % kPoints > 0) return;
    // Lowered so far that the tube's axis passes the centre at that distance.
    const double across = std::sqrt(std::max(1e-6, 1 - dot(direction, down) * dot(direction, down)));
    const double shift = std::min(lower / across, ball.radius * 0.99);
    const auto tube = tube_out_of(ball, ball.centre + down * shift, direction, 1, request_.hole_radius);
    if (!tube) return;
    Place& place = places[i];
    place.hole = {from, *tube, 0};
    if (!reach_surface(place.hole)) return;
    place.cost = sill_of_hole(place.hole, ball, up) - lowest +
                 kShowingWeight * height * showing(place.hole.tube.end) +
                 kLengthWeight * length(place.hole.tube.end - place.hole.tube.start);
  });
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.cost < b.cost; });
  std::vector<EscapeHole> holes;
  for (const Place& place : places) {
    if (place.cost == std::numeric_limits<double>::infinity()) break;
    holes.push_back(place.hole);
  }
  return holes;
}

std::vector<EscapeHole> HolePlaces::leading_to(Vec3d place, std::span<const std::uint32_t> balls) const {
  const Vec3d on_surface = clearance_.nearest_on_surface(place);
  const double off = length(on_surface - place);
  if (off > 2 * request_.hole_radius) {
    const bool outside = outward_.view().winding_number(place) == 0;
    throw UsageError("an escape hole is asked for at " + to_text(place) + ", which is " +
                         std::to_string(off).substr(0, 5) + " mm " +
                         (outside ? "outside the model" : "inside the model, away from its surface"),
                     "the surface is nearest at " + to_text(on_surface));
  }
  std::vector<EscapeHole> holes;
  for (const std::uint32_t from : balls) {
    const Sphere& ball = spheres_[from];
    constexpr int kPoints = 4;
    for (int i = 0; i < 1 + 6 * kPoints; ++i) {
      // The centre, and points around it along the axes.
      const double shift = ball.radius * 0.85 * ((i + 5) / 6) / kPoints;
      constexpr std::array<Vec3d, 6> kAxes{Vec3d{0, 0, -1}, Vec3d{0, 0, 1}, Vec3d{1, 0, 0},
                                           Vec3d{-1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, -1, 0}};
      const Vec3d inside = ball.centre + kAxes[static_cast<std::size_t>((i + 5) % 6)] * shift;
      const double distance = length(on_surface - inside);
      if (distance <= ball.radius) continue;
      const auto tube =
          tube_out_of(ball, inside, (on_surface - inside) * (1 / distance), 1, request_.hole_radius);
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
