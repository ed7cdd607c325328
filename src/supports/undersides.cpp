#include "supports/undersides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <queue>
#include <tbb/parallel_for.h>
#include <utility>

#include "core/ceiling.h"
#include "core/disjoint_sets.h"

namespace aerate {
namespace {

constexpr std::uint32_t kMargin = 8;
constexpr double kOffGridX = 0.4142,
                 kOffGridY = 0.3179;  // no column stands on a coordinate that people choose

// Lines per millimetre of reach and of filament; no more columns than this.
constexpr double kColumnsPerReach = 5;
constexpr double kLeastSpacing = 0.25, kMostSpacing = 0.45;
constexpr double kMostColumns = 2e6;

// What is so near to the model below has no room for supports: it is printed onto that.
constexpr double kLeastLayers = 2;
// And to the plate, whose height layers keep: one is left free, as above a tooth. What is higher is printed two layers above it.
constexpr double kLeastLayersOnPlate = 1.55;

// A step down from one column to the next is level up to this slope.
constexpr double kLevelSlope = 0.2;

struct Step {
  int dx, dy;
  double length;
};
constexpr std::array<Step, 8> kSteps{{{1, 0, 1},
                                      {-1, 0, 1},
                                      {0, 1, 1},
                                      {0, -1, 1},
                                      {1, 1, std::numbers::sqrt2},
                                      {1, -1, std::numbers::sqrt2},
                                      {-1, 1, std::numbers::sqrt2},
                                      {-1, -1, std::numbers::sqrt2}}};

bool holds(const Undersides& columns, std::int64_t x, std::int64_t y) {
  return x >= 0 && y >= 0 && x < columns.count_x && y < columns.count_y;
}

std::size_t column_beside(const Undersides& columns, std::uint32_t span, int dx, int dy) {
  const std::int64_t x = std::int64_t{columns.x_of(span)} + dx, y = std::int64_t{columns.y_of(span)} + dy;
  return holds(columns, x, y) ? columns.column(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))
                              : static_cast<std::size_t>(columns.count_x) * columns.count_y;
}

bool is_a_column(const Undersides& columns, std::size_t column) {
  return column + 1 < columns.first.size();
}

void add_spans(Undersides& columns, const kernels::WindingView& winding) {
  std::vector<std::vector<AirSpan>> by_column(static_cast<std::size_t>(columns.count_x) * columns.count_y);
  tbb::parallel_for(std::uint32_t{0}, columns.count_y, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < columns.count_x; ++x)
      by_column[columns.column(x, y)] = air_spans_at(winding, columns.x_at(x), columns.y_at(y));
  });
  columns.first.assign(1, 0);
  columns.first.reserve(by_column.size() + 1);
  for (std::size_t i = 0; i < by_column.size(); ++i) {
    columns.spans.insert(columns.spans.end(), by_column[i].begin(), by_column[i].end());
    columns.column_of.resize(columns.spans.size(), static_cast<std::uint32_t>(i));
    columns.first.push_back(static_cast<std::uint32_t>(columns.spans.size()));
  }
}

// Spans that hang together with the air round the model.
std::vector<bool> reached_from_outside(const Undersides& columns) {
  std::vector<bool> is_reached(columns.spans.size(), false);
  std::vector<std::uint32_t> open;
  const auto reach = [&](std::uint32_t span) {
    if (is_reached[span]) return;
    is_reached[span] = true;
    open.push_back(span);
  };
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (!std::isfinite(columns.spans[i].ceiling) || !std::isfinite(columns.spans[i].floor)) reach(i);
  }
  while (!open.empty()) {
    const std::uint32_t span = open.back();
    open.pop_back();
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t other = column_beside(columns, span, kSteps[k].dx, kSteps[k].dy);
      if (!is_a_column(columns, other)) continue;
      for (std::uint32_t j = columns.first[other]; j < columns.first[other + 1]; ++j) {
        if (columns.spans[j].floor < columns.spans[span].ceiling &&
            columns.spans[j].ceiling > columns.spans[span].floor)
          reach(j);
      }
    }
  }
  return is_reached;
}

// Whether one piece of solid reaches from one height of a column to another.
bool is_filled(const Undersides& columns, std::size_t column, double lower, double upper) {
  for (std::uint32_t i = columns.first[column]; i + 1 < columns.first[column + 1]; ++i) {
    if (columns.spans[i].ceiling <= lower && columns.spans[i + 1].floor >= upper) return true;
  }
  return false;
}

void find_holds(Undersides& columns, const SupportRules& rules) {
  const double degrees = std::min(rules.degrees + kCeilingMarginDegrees, 89.0);
  const double fall = columns.spacing / std::tan(degrees * std::numbers::pi / 180);
  const std::vector<bool> is_outside = reached_from_outside(columns);
  columns.hold.assign(columns.spans.size(), Hold::none);
  tbb::parallel_for(std::size_t{0}, columns.spans.size(), [&](std::size_t i) {
    const auto span = static_cast<std::uint32_t>(i);
    const double z = columns.spans[span].ceiling;
    if (!std::isfinite(z) || !is_outside[i]) return;
    columns.hold[i] = Hold::bridge;
    if (z <= columns.plate + kLeastLayersOnPlate * rules.layer ||
        z <= columns.spans[span].floor + kLeastLayers * rules.layer)
      columns.hold[i] = Hold::angle;
    for (const Step& step : kSteps) {
      const std::size_t other = column_beside(columns, span, step.dx, step.dy);
      const double lower = step.length * fall;
      if (is_a_column(columns, other) && is_filled(columns, other, z - lower, z - 0.5 * lower))
        columns.hold[i] = Hold::angle;
    }
  });
}

// Where one piece of solid of a column passes into one of the next, as heights rise. A piece is known by the span below it.
void find_tips(Undersides& columns, const SupportRules& rules) {
  std::vector<std::uint32_t> order;
  order.reserve(columns.spans.size());
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (std::isfinite(columns.spans[i].ceiling)) order.push_back(i);
  }
  std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return columns.spans[a].ceiling < columns.spans[b].ceiling;
  });
  const double grounded = columns.plate + kLeastLayersOnPlate * rules.layer;
  const double least_rise = std::max(rules.layer, kLevelSlope * columns.spacing);
  DisjointSets sets(columns.spans.size());
  std::vector<std::uint32_t> lowest(columns.spans.size(), kNoSpan);  // by root
  for (const std::uint32_t span : order) {
    const double z = columns.spans[span].ceiling;
    lowest[span] = span;
    if (columns.spans[span].floor >= z - kLeastLayers * rules.layer) {
      const std::uint32_t low = lowest[sets.root(span - 1)];
      sets.join(span, span - 1);
      lowest[sets.root(span)] = low;
    }
    for (const Step& step : kSteps) {
      const std::size_t other = column_beside(columns, span, step.dx, step.dy);
      if (!is_a_column(columns, other)) continue;
      for (std::uint32_t j = columns.first[other]; j + 1 < columns.first[other + 1]; ++j) {
        if (columns.spans[j].ceiling > z || lowest[sets.root(j)] == kNoSpan) break;
        if (columns.spans[j + 1].floor <= z) continue;  // ends below
        const auto here = static_cast<std::uint32_t>(sets.root(span));
        const auto there = static_cast<std::uint32_t>(sets.root(j));
        if (here == there) continue;
        std::uint32_t older = lowest[here], younger = lowest[there];
        if (columns.spans[younger].ceiling < columns.spans[older].ceiling) std::swap(older, younger);
        const double begins = columns.spans[younger].ceiling;
        if (begins > grounded && z - begins > least_rise && columns.hold[younger] != Hold::none)
          columns.tips.push_back(younger);
        sets.join(here, there);
        lowest[sets.root(span)] = older;
      }
    }
  }
  // What joins nothing: a part of its own above the plate.
  for (const std::uint32_t span : order) {
    if (sets.root(span) != span) continue;
    const std::uint32_t low = lowest[span];
    if (columns.spans[low].ceiling > grounded && columns.hold[low] != Hold::none) columns.tips.push_back(low);
  }
  std::ranges::sort(columns.tips);
}

Undersides columns_in(const Box3d& box, const kernels::WindingView& winding, double plate, double spacing) {
  Undersides columns;
  columns.spacing = spacing;
  columns.plate = plate;
  columns.origin_x = box.lower.x - (kMargin + kOffGridX) * spacing;
  columns.origin_y = box.lower.y - (kMargin + kOffGridY) * spacing;
  const auto count = [&](double lower, double upper) {
    return static_cast<std::uint32_t>(std::ceil((upper - lower) / spacing)) + 2 * kMargin + 1;
  };
  columns.count_x = count(box.lower.x, box.upper.x);
  columns.count_y = count(box.lower.y, box.upper.y);
  add_spans(columns, winding);
  return columns;
}

// A span whose ceiling is held by what is at a place, mm, so far away.
struct Reached {
  double distance;
  std::uint32_t span;
  double from_x, from_y;

  bool operator<(const Reached& other) const {
    return distance != other.distance ? distance > other.distance : span > other.span;
  }
};

void spread(const Undersides& columns, std::priority_queue<Reached> open, std::vector<double>& distances) {
  while (!open.empty()) {
    const Reached at = open.top();
    open.pop();
    if (at.distance > distances[at.span]) continue;
    for (const Step& step : kSteps) {
      const std::uint32_t other = columns.next(at.span, step.dx, step.dy);
      if (other == kNoSpan || columns.hold[other] != Hold::bridge) continue;
      // What is printed earlier is not held by what comes later.
      if (columns.spans[other].ceiling <
          columns.spans[at.span].ceiling - kLevelSlope * step.length * columns.spacing)
        continue;
      const double away = std::hypot(columns.x_at(columns.x_of(other)) - at.from_x,
                                     columns.y_at(columns.y_of(other)) - at.from_y);
      const double distance = std::max(at.distance, away);
      if (distance >= distances[other]) continue;
      distances[other] = distance;
      open.push({distance, other, at.from_x, at.from_y});
    }
  }
}

void add_holders(const std::vector<Holder>& held, std::priority_queue<Reached>& open,
                 std::vector<double>& distances) {
  for (const Holder& holder : held) {
    distances[holder.span] = 0;
    open.push({0, holder.span, holder.x, holder.y});
  }
}

}  // namespace

bool Undersides::is_solid(std::size_t column, double z) const {
  for (std::uint32_t i = first[column]; i < first[column + 1]; ++i) {
    if (z <= spans[i].ceiling) return z < spans[i].floor;
  }
  return false;
}

double Undersides::height_above_model(std::size_t column, double z) const {
  for (std::uint32_t i = first[column]; i < first[column + 1]; ++i)
    if (spans[i].floor < z && z < spans[i].ceiling) return z - spans[i].floor;
  return kInfinity;
}

std::optional<std::size_t> Undersides::column_at(double x, double y) const {
  const long at_x = std::lround((x - origin_x) / spacing), at_y = std::lround((y - origin_y) / spacing);
  if (!holds(*this, at_x, at_y)) return std::nullopt;
  return column(static_cast<std::uint32_t>(at_x), static_cast<std::uint32_t>(at_y));
}

std::uint32_t Undersides::next(std::uint32_t span, int dx, int dy) const {
  constexpr double kSteepest = 3;  // a wall is no part of it
  const std::size_t other = column_beside(*this, span, dx, dy);
  if (!is_a_column(*this, other)) return kNoSpan;
  std::uint32_t best = kNoSpan;
  double least = kSteepest * spacing * (dx != 0 && dy != 0 ? std::numbers::sqrt2 : 1);
  for (std::uint32_t j = first[other]; j < first[other + 1]; ++j) {
    const double rise = std::abs(spans[j].ceiling - spans[span].ceiling);
    const bool meets = spans[j].floor < spans[span].ceiling && spans[j].ceiling > spans[span].floor;
    if (meets && rise <= least && hold[j] != Hold::none) {
      least = rise;
      best = j;
    }
  }
  return best;
}

double column_spacing(const Mesh& upright, const SupportRules& rules) {
  const Box3f box = bounding_box(upright);
  const double wanted = std::clamp(rules.reach / kColumnsPerReach, kLeastSpacing, kMostSpacing);
  const double area = (static_cast<double>(box.upper.x) - static_cast<double>(box.lower.x)) *
                      (static_cast<double>(box.upper.y) - static_cast<double>(box.lower.y));
  return std::max(wanted, std::sqrt(area / kMostColumns));
}

Undersides columns_of(const kernels::WindingView& winding, double plate, double spacing) {
  return columns_in(winding.box, winding, plate, spacing);
}

Undersides find_undersides(const Mesh& upright, const kernels::WindingView& winding,
                           const SupportRules& rules, double plate, double spacing) {
  const Box3f box = bounding_box(upright);
  Undersides columns = columns_in({to_double(box.lower), to_double(box.upper)}, winding, plate, spacing);
  find_holds(columns, rules);
  find_tips(columns, rules);
  return columns;
}

Holder holder_in(const Undersides& columns, std::uint32_t span) {
  return {span, columns.x_at(columns.x_of(span)), columns.y_at(columns.y_of(span))};
}

std::vector<double> distances_from_hold(const Undersides& columns, const std::vector<Holder>& held) {
  std::vector<double> distances(columns.spans.size(), kInfinity);
  std::priority_queue<Reached> open;
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (columns.hold[i] != Hold::angle) continue;
    distances[i] = 0;
    const Holder own = holder_in(columns, i);
    open.push({0, i, own.x, own.y});
  }
  // A tip is held by nothing but what is under it.
  for (const std::uint32_t tip : columns.tips) distances[tip] = kInfinity;
  add_holders(held, open, distances);
  spread(columns, std::move(open), distances);
  return distances;
}

void hold_also(const Undersides& columns, const std::vector<Holder>& held, std::vector<double>& distances) {
  std::priority_queue<Reached> open;
  add_holders(held, open, distances);
  spread(columns, std::move(open), distances);
}

}  // namespace aerate
