#include "printing/economics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "printing/shell_rules.h"

namespace aerate {
namespace {

// Voids in company share skins and walls: they pay from this share of the radius on that a lone one needs.
// Fitted.
constexpr double kCompanyShare = 0.8;

// For the time: speeds, mm/s, that PrusaSlicer's estimates come to with its default speeds and accelerations,
// fitted to three models (docs/economics.md). Gyroid is slow since it turns all the time.
constexpr double kStraightInfillSpeed = 60;
constexpr double kGyroidSpeed = 31;
constexpr double kWallSpeed = 20;
constexpr double kVoidWallSpeed = 16;
constexpr double kSmallVoidWallSpeed = 9.5;  // below this radius:
constexpr double kSmallWallRadius = 6.5;
// And for the way to a contour of its own, its seam and retraction, s.
constexpr double kSecondsPerContour = 0.25;
// Differences of the time below this share are not told.
constexpr double kSameTime = 0.05;

}  // namespace

FilamentUse use_of_lone_void(double radius, const PrintSettings& settings) {
  const ShellRules rules = shell_rules(settings);
  const double h = settings.layer_height, half_line = rules.spacing / 2;
  // The void's radius in a layer; its centre lies between two layers.
  const auto hole = [&](long k) {
    const double z = (static_cast<double>(k) + 0.5) * h;
    return z * z < radius * radius ? std::sqrt(radius * radius - z * z) : 0.0;
  };
  const auto fill = [&](long k) { return hole(k) > 0 ? hole(k) + rules.fill : 0.0; };
  // Up to where the layer's infill looks that way; 0 if nothing of it does. It is skin up to a margin further.
  const auto exposed = [&](long k, long direction) {
    const double other = hole(k + direction);
    return other > fill(k) ? other : 0.0;
  };
  const auto skin = [&](long k, long direction) {
    const double end = exposed(k, direction);
    return end > 0 ? end + rules.skin_margin : 0.0;
  };
  const long reach = std::lround(std::ceil(radius / h)) + std::max(rules.top_layers, rules.bottom_layers) + 1;
  FilamentUse use;
  for (long k = -reach; k < reach; ++k) {
    const double own = hole(k), start = fill(k);
    // Up to where the layers above and below leave nothing, or shade this one.
    double covered = 0, shaded = 0;
    const auto look = [&](long direction, int count) {
      for (int step = 1; step <= count; ++step) {
        const long at = k + step * direction;
        const double other = hole(at);
        covered = std::max(covered, rules.walls_cover && step < count ? fill(at) : other);
        if (other > hole(at - direction) + rules.lean) covered = std::max(covered, other + rules.shadow);
        const double looking = exposed(at, direction);
        if (step < count && looking > 0) shaded = std::max(shaded, looking + rules.skin_shadow);
      }
    };
    look(+1, rules.top_layers);
    look(-1, rules.bottom_layers);
    double end = start;  // of what is solid
    const double shell = std::max(shaded, covered - start >= rules.least_shell ? covered : 0);
    if (shell > start) end = shell + rules.widening;
    if (rules.top_layers > 0) end = std::max(end, skin(k, +1));
    if (rules.bottom_layers > 0) end = std::max(end, skin(k, -1));
    if (end <= 0) continue;
    const double wall = own > 0 ? own + rules.wall : 0, sparse = end + half_line;
    use.wall_mm3 += h * std::numbers::pi * (wall * wall - own * own - 2 * own * rules.round_edge);
    use.solid_mm3 += h * std::numbers::pi * (end * end - start * start);
    use.sparse_mm3 -= h * std::numbers::pi * sparse * sparse;
    use.full_mm3 -= h * std::numbers::pi * end * end;
    use.edge_mm3 += h * rules.spacing * 2 * std::numbers::pi * sparse;
  }
  return use;
}

std::optional<double> break_even_radius(const PrintSettings& settings) {
  const auto costs = [&](double radius) {
    return use_of_lone_void(radius, settings).volume_mm3(settings) > 0;
  };
  // Layers make the cost of small voids jump, so the largest radius that costs is looked for from above.
  constexpr double kSmallest = 0.3, kLargest = 300, kStep = 1.1;
  if (costs(kLargest)) return std::nullopt;
  double saving = kLargest, costing = kLargest / kStep;
  while (costing > kSmallest && !costs(costing)) saving = costing, costing /= kStep;
  if (costing <= kSmallest) return 0;
  for (int i = 0; i < 30; ++i) {
    const double middle = (saving + costing) / 2;
    (costs(middle) ? costing : saving) = middle;
  }
  return kCompanyShare * saving;
}

std::optional<double> break_even_infill(double radius, const PrintSettings& settings) {
  return break_even_infill(use_of_lone_void(radius, settings), settings);
}

std::optional<double> break_even_infill(const FilamentUse& difference, const PrintSettings& settings) {
  PrintSettings solid = settings;
  solid.infill = 1;
  if (difference.volume_mm3(solid) >= 0 || difference.sparse_mm3 >= 0) return std::nullopt;
  // It falls with the infill. A solid print has no joints.
  const auto costs = [&](double infill) {
    PrintSettings tried = settings;
    tried.infill = infill;
    return difference.volume_mm3(tried) > 0;
  };
  double costing = std::numeric_limits<double>::min(), saving = 1;
  if (!costs(costing)) return 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = (costing + saving) / 2;
    (costs(middle) ? costing : saving) = middle;
  }
  return saving;
}

TimeChange time_change(const FilamentUse& whole, const FilamentUse& hollow, std::span<const Sphere> voids,
                       const PrintSettings& settings) {
  const double section = shell_rules(settings).spacing * settings.layer_height;
  const bool waves = settings.infill < 1 && settings.pattern == InfillPattern::gyroid;
  const double sparse_speed = waves ? kGyroidSpeed : kStraightInfillSpeed;
  const auto infill_seconds = [&](const FilamentUse& use) {
    const double sparse = use.volume_mm3(settings) - use.wall_mm3 - use.solid_mm3;
    return (use.solid_mm3 / kStraightInfillSpeed + sparse / sparse_speed) / section;
  };
  const double walls = whole.wall_mm3 / section / kWallSpeed;
  const double before = infill_seconds(whole) + walls;
  double after = infill_seconds(hollow) + walls;
  // Walls round voids: what there is in all, at the speeds of those that each void alone would have.
  double length = 0, seconds = 0;
  for (const Sphere& sphere : voids) {
    const auto layers = static_cast<long>(sphere.radius / settings.layer_height);
    for (long k = -layers; k < layers; ++k) {
      const double z = (static_cast<double>(k) + 0.5) * settings.layer_height;
      const double radius = std::sqrt(std::max(0.0, sphere.radius * sphere.radius - z * z));
      const double round = settings.perimeters * 2 * std::numbers::pi * radius;
      length += round;
      seconds += round / (radius < kSmallWallRadius ? kSmallVoidWallSpeed : kVoidWallSpeed);
      after += kSecondsPerContour;
    }
  }
  const double added = std::max(0.0, hollow.wall_mm3 - whole.wall_mm3) / section;
  if (length > 0) after += added * seconds / length;
  if (std::abs(after - before) <= kSameTime * before) return TimeChange::same;
  return after > before ? TimeChange::longer : TimeChange::shorter;
}

}  // namespace aerate
