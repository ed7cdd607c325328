#include "packing/hole_rules.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <utility>

#include "core/error.h"

namespace aerate {
namespace {

// The longest hole, in its diameters and walls together.
constexpr double kLongestInDiameters = 3;
constexpr double kLongestInWalls = 3;

constexpr int kDirections = 64;

}  // namespace

double longest_hole(const DrainageRequest& request, const PackingLimits& limits) {
  return kLongestInDiameters * 2 * request.hole_radius + kLongestInWalls * limits.wall;
}

bool leads_outside(const Tube& tube, double wall, const TubeClearance& clearance,
                   const kernels::WindingView& outward) {
  const Vec3d axis = direction_of(tube);
  const double needed = tube.radius + wall;
  for (const double beyond : {tube.radius, 2 * tube.radius}) {
    const Vec3d p = tube.end + axis * beyond;
    if (clearance.to_surface(p, needed) < kLeastSlope * beyond / 2) return false;
    if (outward.winding_number(p) != 0) return false;
  }
  return true;
}

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

Vec3d on_surface_near(Vec3d place, double within, const TubeClearance& clearance,
                      const kernels::WindingView& outward) {
  const Vec3d on_surface = clearance.nearest_on_surface(place);
  const double off = length(on_surface - place);
  if (off <= within) return on_surface;
  const auto to_text = [](Vec3d p) { return fmt::format("({:.2f}, {:.2f}, {:.2f}) mm", p.x, p.y, p.z); };
  const bool outside = outward.winding_number(place) == 0;
  throw UsageError(fmt::format("an escape hole is asked for at {}, which is {} mm {}", to_text(place),
                               fmt::format("{:f}", off).substr(0, 5),
                               outside ? "outside the model" : "inside the model, away from its surface"),
                   "the surface is nearest at " + to_text(on_surface));
}

std::optional<Vec3d> nearest_place(Vec3d place, double longest, const TubeClearance& clearance,
                                   const std::function<bool(Vec3d place)>& opens) {
  constexpr int kRounds = 12;
  const auto in_hundredths = [](double x) { return std::round(100 * x) / 100; };
  std::vector<std::pair<double, Vec3d>> places;
  for (const Vec3d axis : {Vec3d{0, 0, 1}, Vec3d{0, 0, -1}}) {
    for (const Vec3d direction : directions_about(axis)) {
      for (int round = 1; round <= kRounds; ++round) {
        const Vec3d at = clearance.nearest_on_surface(place + direction * (2 * longest * round / kRounds));
        const Vec3d told{in_hundredths(at.x), in_hundredths(at.y), in_hundredths(at.z)};
        places.emplace_back(length(told - place), told);
      }
    }
  }
  std::ranges::stable_sort(places, {}, &std::pair<double, Vec3d>::first);
  places.erase(std::unique(places.begin(), places.end(),
                           [](const auto& a, const auto& b) { return a.second == b.second; }),
               places.end());
  for (const auto& [distance, at] : places) {
    if (distance <= 2 * longest && opens(at)) return at;
  }
  return std::nullopt;
}

}  // namespace aerate
