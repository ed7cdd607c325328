#include "supports/teeth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <unordered_map>
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

// Parallel lines through a piece.
struct Lines {
  bool along_x = true;
  std::uint32_t phase = 0;
};

class LineChoice {
 public:
  LineChoice(const Undersides& columns, const std::vector<std::uint32_t>& piece,
             const std::vector<double>& distances, double reach)
      : columns_(columns),
        piece_(piece),
        distances_(distances),
        reach_(reach),
        pitch_(std::max(1U, static_cast<std::uint32_t>(2 * reach / columns.spacing))) {
    at_.reserve(piece.size());
    for (const std::uint32_t span : piece) at_[key(columns.x_of(span), columns.y_of(span))] = span;
  }

  bool is_on(Lines lines, std::uint32_t span) const {
    return across(lines, span) % pitch_ == lines.phase && distances_[span] > kCloseToHold * reach_;
  }

  Lines best() const {
    Lines best;
    double least = kInfinity;
    for (const bool along_x : {false, true}) {
      for (std::uint32_t phase = 0; phase < pitch_; ++phase) {
        const double cost = cost_of({along_x, phase});
        if (cost < least) {
          least = cost;
          best = {along_x, phase};
        }
      }
    }
    return best;
  }

 private:
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    return (static_cast<std::uint64_t>(x) << 32) | static_cast<std::uint32_t>(y);
  }
  std::uint32_t across(Lines lines, std::uint32_t span) const {
    return lines.along_x ? columns_.y_of(span) : columns_.x_of(span);
  }
  // Columns with a ridge, and what would have to be held besides.
  double cost_of(Lines lines) const {
    constexpr double kMissed = 0.5;  // columns of ridge for each that lines miss
    double cost = 0;
    for (const std::uint32_t span : piece_) {
      if (is_on(lines, span)) ++cost;
      if (distances_[span] > reach_ && !is_near(lines, span)) cost += kMissed;
    }
    return cost;
  }
  bool is_near(Lines lines, std::uint32_t span) const {
    const std::int64_t here = across(lines, span);
    const std::int64_t off = (here % pitch_ + pitch_ - lines.phase) % pitch_;
    const std::int64_t along = lines.along_x ? columns_.x_of(span) : columns_.y_of(span);
    const auto half = static_cast<std::int64_t>(reach_ / columns_.spacing);
    for (const std::int64_t line : {here - off, here - off + pitch_}) {
      if (std::abs(line - here) > half) continue;
      if (at_.contains(lines.along_x ? key(along, line) : key(line, along))) return true;
    }
    return false;
  }

  const Undersides& columns_;
  const std::vector<std::uint32_t>& piece_;
  const std::vector<double>& distances_;
  double reach_;
  std::uint32_t pitch_;
  std::unordered_map<std::uint64_t, std::uint32_t> at_;
};

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
    hold_also(columns, span, kInfinity, distances);
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

// Rows along the way that most of a column's neighbours are on; each column in one row, and in another where rows meet.
std::vector<RidgeRun> runs_of(const Undersides& columns, const std::vector<std::uint8_t>& is_held) {
  const auto neighbour = [&](std::uint32_t span, bool along_x, int by) -> std::uint32_t {
    const std::uint32_t other = columns.next(span, along_x ? by : 0, along_x ? 0 : by);
    if (other == kNoSpan || is_held[other] == 0) return kNoSpan;
    return other;
  };
  std::vector<RidgeRun> runs;
  for (const bool along_x : {true, false}) {
    std::vector<std::uint8_t> is_done(columns.spans.size(), 0);
    for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
      if (is_held[i] == 0 || is_done[i] != 0) continue;
      std::uint32_t begin = i;
      for (std::uint32_t before = neighbour(begin, along_x, -1); before != kNoSpan && is_done[before] == 0;
           before = neighbour(begin, along_x, -1)) {
        begin = before;
        if (begin == i) break;
      }
      RidgeRun run{{}, along_x};
      for (std::uint32_t at = begin; at != kNoSpan && is_done[at] == 0; at = neighbour(at, along_x, 1)) {
        is_done[at] = 1;
        run.spans.push_back(at);
      }
      const bool is_alone = run.spans.size() == 1;
      const bool has_other_way =
          neighbour(begin, !along_x, 1) != kNoSpan || neighbour(begin, !along_x, -1) != kNoSpan;
      if (!is_alone || (along_x && !has_other_way)) runs.push_back(std::move(run));
    }
  }
  return runs;
}

}  // namespace

TeethPlan plan_teeth(const Undersides& columns, const SupportRules& rules, ToothKind kind) {
  const std::vector<double> own = distances_from_hold(columns, {});
  const auto pieces = overhanging_pieces(columns, own, rules.reach);
  TeethPlan plan;
  plan.kind = kind;
  std::vector<std::uint8_t> is_held(columns.spans.size(), 0), is_carried(columns.spans.size(), 0);
  for (const std::vector<std::uint32_t>& piece : pieces) {
    for (const std::uint32_t span : piece) is_carried[span] = own[span] > kCloseToHold * rules.reach ? 1 : 0;
    if (kind != ToothKind::ridge) continue;
    const LineChoice choice(columns, piece, own, rules.reach);
    const Lines lines = choice.best();
    for (const std::uint32_t span : piece) {
      const bool is_edge = own[span] > kCloseToHold * rules.reach && is_free_edge(columns, span);
      if (is_edge || choice.is_on(lines, span)) is_held[span] = 1;
    }
  }
  std::vector<std::uint32_t> held;
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (is_held[i] != 0) held.push_back(i);
  }
  std::vector<double> distances = distances_from_hold(columns, held);
  hold_what_is_left(columns, rules.reach, distances, is_held);
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (is_held[i] != 0) {
      plan.held.push_back(i);
      is_carried[i] = 1;
    }
    if (is_carried[i] != 0) plan.carried.push_back(i);
  }
  if (kind == ToothKind::ridge) plan.runs = runs_of(columns, is_held);
  return plan;
}

}  // namespace aerate
