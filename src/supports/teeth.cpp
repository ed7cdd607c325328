#include "supports/teeth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>

#include "core/disjoint_sets.h"

namespace aerate {
namespace {

// Nothing touches what is nearer than this to what holds it, in reaches.
constexpr double kCloseToHold = 0.6;

constexpr std::array<std::pair<int, int>, 4> kForward{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
constexpr std::array<std::pair<int, int>, 4> kSides{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

bool leans(const Undersides& columns, std::uint32_t span) {
  return columns.hold[span] == Hold::bridge;
}

// Pieces of underside that lean out and that hang together, those that need teeth.
std::vector<std::vector<std::uint32_t>> overhanging_pieces(const Undersides& columns,
                                                           const std::vector<double>& distances,
                                                           double reach) {
  DisjointSets sets(columns.spans.size());
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (!leans(columns, i)) continue;
    for (const auto& [dx, dy] : kForward) {
      const std::uint32_t other = columns.next(i, dx, dy);
      if (other != kNoSpan && leans(columns, other)) sets.join(i, other);
    }
  }
  std::vector<bool> needs(columns.spans.size(), false);
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (leans(columns, i) && distances[i] > reach) needs[sets.root(i)] = true;
  }
  std::vector<std::vector<std::uint32_t>> pieces;
  std::vector<std::uint32_t> number(columns.spans.size(), kNoSpan);
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (!leans(columns, i)) continue;
    const std::uint32_t root = sets.root(i);
    if (!needs[root]) continue;
    if (number[root] == kNoSpan) {
      number[root] = static_cast<std::uint32_t>(pieces.size());
      pieces.emplace_back();
    }
    pieces[number[root]].push_back(i);
  }
  return pieces;
}

// The ceiling ends in the air there.
bool is_free_edge(const Undersides& columns, std::uint32_t span) {
  const double above = columns.spans[span].ceiling + 0.1 * columns.spacing;
  return std::ranges::any_of(kSides, [&](const std::pair<int, int>& side) {
    if (columns.next(span, side.first, side.second) != kNoSpan) return false;
    const std::int64_t x = std::int64_t{columns.x_of(span)} + side.first;
    const std::int64_t y = std::int64_t{columns.y_of(span)} + side.second;
    return !columns.is_solid(columns.column(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)),
                             above);
  });
}

// The farthest first, the lowest of those that nothing holds.
struct Need {
  double distance, height;
  std::uint32_t span;

  bool operator<(const Need& other) const {
    if (distance != other.distance) return distance < other.distance;
    return height != other.height ? height > other.height : span > other.span;
  }
};

void hold_what_is_left(const Undersides& columns, double reach, std::vector<double>& distances,
                       std::vector<std::uint8_t>& is_held) {
  const auto hold = [&](std::uint32_t span) {
    is_held[span] = 1;
    hold_also(columns, {holder_in(columns, span)}, distances);
  };
  std::vector<std::uint32_t> tips = columns.tips;
  std::ranges::stable_sort(tips, [&](std::uint32_t a, std::uint32_t b) {
    return columns.spans[a].ceiling < columns.spans[b].ceiling;
  });
  for (const std::uint32_t tip : tips) {
    if (is_held[tip] == 0) hold(tip);
  }
  std::priority_queue<Need> needs;
  const auto add = [&](std::uint32_t span) {
    if (leans(columns, span) && distances[span] > reach)
      needs.push({distances[span], columns.spans[span].ceiling, span});
  };
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) add(i);
  while (!needs.empty()) {
    const Need need = needs.top();
    needs.pop();
    if (distances[need.span] <= reach) continue;
    if (distances[need.span] < need.distance) {
      add(need.span);
      continue;
    }
    hold(need.span);
  }
}

std::vector<Holder> holders_of(const std::vector<RidgeRun>& runs) {
  std::vector<Holder> holders;
  for (const RidgeRun& run : runs)
    for (const RidgePoint& p : run.points) holders.push_back({p.span, p.x, p.y});
  return holders;
}

struct PlannedRidges {
  std::vector<RidgeRun> runs;
  std::vector<double> distances;  // by span, mm
};

// `pieces`: of underside, and their distances from what holds them by itself
PlannedRidges plan_ridges(const Undersides& columns, const std::vector<std::vector<std::uint32_t>>& pieces,
                          const std::vector<double>& own, double reach) {
  const double close = kCloseToHold * reach;
  PlannedRidges planned{{}, own};
  std::vector<std::vector<RidgeRun>> edges(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    std::vector<std::uint32_t> at_edge;
    for (const std::uint32_t span : pieces[i])
      if (own[span] > close && is_free_edge(columns, span)) at_edge.push_back(span);
    edges[i] = edge_ridges(columns, at_edge);
    hold_also(columns, holders_of(edges[i]), planned.distances);
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const std::vector<RidgeRun> lines =
        parallel_ridges(columns, pieces[i], edges[i], own, planned.distances, close, reach);
    hold_also(columns, holders_of(lines), planned.distances);
    for (const std::vector<RidgeRun>* runs : {&std::as_const(edges[i]), &lines})
      planned.runs.insert(planned.runs.end(), runs->begin(), runs->end());
  }
  return planned;
}

}  // namespace

TeethPlan plan_teeth(const Undersides& columns, const SupportRules& rules, ToothKind kind) {
  const std::vector<double> own = distances_from_hold(columns, {});
  const auto pieces = overhanging_pieces(columns, own, rules.reach);
  TeethPlan plan;
  plan.kind = kind;
  plan.reach = rules.reach;
  std::vector<std::uint8_t> is_held(columns.spans.size(), 0), is_carried(columns.spans.size(), 0);
  for (const std::vector<std::uint32_t>& piece : pieces)
    for (const std::uint32_t span : piece) is_carried[span] = own[span] > kCloseToHold * rules.reach ? 1 : 0;
  std::vector<double> distances = own;
  if (kind == ToothKind::ridge) {
    PlannedRidges planned = plan_ridges(columns, pieces, own, rules.reach);
    plan.runs = std::move(planned.runs);
    distances = std::move(planned.distances);
    for (const RidgeRun& run : plan.runs)
      for (const RidgePoint& p : run.points) is_held[p.span] = 1;
  }
  std::vector<std::uint8_t> is_alone = is_held;
  hold_what_is_left(columns, rules.reach, distances, is_alone);
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (is_alone[i] != 0) {
      plan.held.push_back(i);
      is_carried[i] = 1;
      const Holder middle = holder_in(columns, i);
      if (kind == ToothKind::ridge && is_held[i] == 0) plan.runs.push_back({{{middle.x, middle.y, i}}});
    }
    if (is_carried[i] != 0) plan.carried.push_back(i);
  }
  return plan;
}

}  // namespace aerate
