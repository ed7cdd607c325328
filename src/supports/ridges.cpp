#include "supports/ridges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <tbb/parallel_for.h>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace aerate {
namespace {

// Columns of a straight edge lie within one of a line.
constexpr double kStraight = 0.8;
// Where an edge turns by more than this, cosine, a ridge ends and another begins.
constexpr double kCorner = 0.707;

// Sides first, then corners.
constexpr std::array<std::pair<int, int>, 8> kAround{
    {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};

// In columns.
struct At {
  double x, y;
};

At at_column(const Undersides& columns, std::uint32_t span) {
  return {static_cast<double>(columns.x_of(span)), static_cast<double>(columns.y_of(span))};
}

RidgePoint point_at(const Undersides& columns, At at, std::uint32_t span) {
  return {columns.origin_x + columns.spacing * at.x, columns.origin_y + columns.spacing * at.y, span};
}

// Spans one after another, each beside the next.
using Chain = std::vector<std::uint32_t>;

class Chains {
 public:
  Chains(const Undersides& columns, const std::vector<std::uint32_t>& spans)
      : columns_(columns), open_(spans.begin(), spans.end()) {}

  std::vector<Chain> trace(const std::vector<std::uint32_t>& spans) {
    const std::unordered_set<std::uint32_t> all = open_;
    const auto ends = [&](std::uint32_t span) {
      return std::ranges::count_if(kAround, [&](std::pair<int, int> side) {
               const std::uint32_t other = columns_.next(span, side.first, side.second);
               return other != kNoSpan && all.contains(other);
             }) == 1;
    };
    std::vector<Chain> chains;
    for (const std::uint32_t span : spans)
      if (open_.contains(span) && ends(span)) add(chains, span, all);
    for (const std::uint32_t span : spans)
      if (open_.contains(span)) add(chains, span, all);
    return chains;
  }

 private:
  void add(std::vector<Chain>& chains, std::uint32_t first, const std::unordered_set<std::uint32_t>& all) {
    Chain chain{first};
    open_.erase(first);
    for (std::uint32_t at = onward(first); at != kNoSpan; at = onward(at)) {
      chain.push_back(at);
      open_.erase(at);
    }
    constexpr std::size_t kLeast = 3, kLoop = 6;
    if (chain.size() >= kLoop && is_beside(chain.back(), first)) chain.push_back(first);
    // Beside another chain.
    if (chain.size() < kLeast && has_neighbour(chain, all)) return;
    chains.push_back(std::move(chain));
  }
  std::uint32_t onward(std::uint32_t span) const {
    for (const auto& [dx, dy] : kAround) {
      const std::uint32_t other = columns_.next(span, dx, dy);
      if (other != kNoSpan && open_.contains(other)) return other;
    }
    return kNoSpan;
  }
  bool is_beside(std::uint32_t span, std::uint32_t other) const {
    return std::ranges::any_of(kAround, [&](std::pair<int, int> side) {
      return columns_.next(span, side.first, side.second) == other;
    });
  }
  bool has_neighbour(const Chain& chain, const std::unordered_set<std::uint32_t>& all) const {
    return std::ranges::any_of(chain, [&](std::uint32_t span) {
      return std::ranges::any_of(kAround, [&](std::pair<int, int> side) {
        const std::uint32_t other = columns_.next(span, side.first, side.second);
        return other != kNoSpan && all.contains(other) && std::ranges::find(chain, other) == chain.end();
      });
    });
  }

  const Undersides& columns_;
  std::unordered_set<std::uint32_t> open_;
};

// Indices of points between which a chain is straight (D. Douglas and T. Peucker, 1973), the first and the last among them.
std::vector<std::size_t> corners_of(std::span<const At> points) {
  std::vector<std::size_t> corners{0};
  std::vector<std::size_t> ends{points.size() - 1};
  while (!ends.empty()) {
    const std::size_t from = corners.back(), to = ends.back();
    const double dx = points[to].x - points[from].x, dy = points[to].y - points[from].y;
    const double length = std::hypot(dx, dy);
    double farthest = kStraight;
    std::size_t split = to;
    for (std::size_t i = from + 1; i < to; ++i) {
      const double px = points[i].x - points[from].x, py = points[i].y - points[from].y;
      const double off = length > 0 ? std::abs(dx * py - dy * px) / length : std::hypot(px, py);
      if (off <= farthest) continue;
      farthest = off;
      split = i;
    }
    if (split != to) {
      ends.push_back(split);
      continue;
    }
    ends.pop_back();
    corners.push_back(to);
  }
  return corners;
}

At projected(At p, At from, At to) {
  const double dx = to.x - from.x, dy = to.y - from.y;
  const double squared = dx * dx + dy * dy;
  const double share =
      squared > 0 ? std::clamp(((p.x - from.x) * dx + (p.y - from.y) * dy) / squared, 0.0, 1.0) : 0;
  return {from.x + share * dx, from.y + share * dy};
}

double cosine(At a, At b) {
  const double length = std::hypot(a.x, a.y) * std::hypot(b.x, b.y);
  return length > 0 ? (a.x * b.x + a.y * b.y) / length : 1;
}

void add_straightened(const Undersides& columns, const Chain& chain, std::vector<RidgeRun>& runs) {
  std::vector<At> centres;
  centres.reserve(chain.size());
  for (const std::uint32_t span : chain) centres.push_back(at_column(columns, span));
  const std::vector<std::size_t> corners = corners_of(centres);
  RidgeRun run{{point_at(columns, centres[0], chain[0])}};
  const auto way = [&](std::size_t k) {
    return At{centres[corners[k]].x - centres[corners[k - 1]].x,
              centres[corners[k]].y - centres[corners[k - 1]].y};
  };
  for (std::size_t k = 1; k < corners.size(); ++k) {
    const At from = centres[corners[k - 1]], to = centres[corners[k]];
    for (std::size_t i = corners[k - 1] + 1; i <= corners[k]; ++i)
      run.points.push_back(point_at(columns, projected(centres[i], from, to), chain[i]));
    if (k + 1 == corners.size() || cosine(way(k), way(k + 1)) >= kCorner) continue;
    const RidgePoint corner = run.points.back();
    runs.push_back(std::move(run));
    run = RidgeRun{{corner}};
  }
  runs.push_back(std::move(run));
}

// Directions to try, as angles in [0, pi): some all round, and along and across the longest straight edge.
std::vector<double> angles_to_try(const Undersides& columns, const std::vector<RidgeRun>& edges) {
  constexpr int kAll = 8;
  std::vector<double> angles;
  angles.reserve(kAll + 2);
  for (int i = 0; i < kAll; ++i) angles.push_back(std::numbers::pi * i / kAll);
  double longest = 0;
  At way{1, 0};
  for (const RidgeRun& run : edges) {
    std::vector<At> points;
    points.reserve(run.points.size());
    for (const RidgePoint& p : run.points) points.push_back({p.x / columns.spacing, p.y / columns.spacing});
    if (points.size() < 2) continue;
    const std::vector<std::size_t> corners = corners_of(points);
    for (std::size_t k = 1; k < corners.size(); ++k) {
      const At from = points[corners[k - 1]], to = points[corners[k]];
      const double length = std::hypot(to.x - from.x, to.y - from.y);
      // By a whole column, so that edges of the same length do not take turns.
      if (length <= longest + 1) continue;
      longest = length;
      way = {to.x - from.x, to.y - from.y};
    }
  }
  if (longest == 0 || way.x == 0 || way.y == 0) return angles;
  const double along = std::atan2(way.y, way.x);
  for (const double angle : {along, along + std::numbers::pi / 2})
    angles.push_back(std::fmod(angle + 2 * std::numbers::pi, std::numbers::pi));
  return angles;
}

// Parallel lines, in columns.
struct Lines {
  double angle = 0;
  At along{1, 0}, across{0, 1};
  std::uint32_t phase = 0;

  explicit Lines(double a) : angle(a), along{std::cos(a), std::sin(a)}, across{-std::sin(a), std::cos(a)} {
    // Of lines along an axis columns are whole numbers apart.
    for (double* part : {&along.x, &along.y, &across.x, &across.y})
      if (std::abs(*part) < 1e-12) *part = 0;
  }
  bool is_along_x() const { return std::abs(along.x) >= std::abs(along.y); }
  // Each line takes one column of every row across it.
  double half() const { return 0.5 * std::max(std::abs(across.x), std::abs(across.y)); }
  double length_of_a_column() const { return 1 / std::max(std::abs(along.x), std::abs(along.y)); }
};

class LineChoice {
 public:
  LineChoice(const Undersides& columns, const std::vector<std::uint32_t>& piece,
             const std::vector<double>& own, const std::vector<double>& with_edges, double close,
             double reach)
      : columns_(columns),
        piece_(piece),
        own_(own),
        with_edges_(with_edges),
        close_(close),
        reach_(reach),
        pitch_(std::max(1U, static_cast<std::uint32_t>(2 * reach / columns.spacing))) {
    low_x_ = low_y_ = kNoSpan;
    std::uint32_t high_x = 0, high_y = 0;
    for (const std::uint32_t span : piece) {
      low_x_ = std::min(low_x_, columns.x_of(span));
      low_y_ = std::min(low_y_, columns.y_of(span));
      high_x = std::max(high_x, columns.x_of(span));
      high_y = std::max(high_y, columns.y_of(span));
    }
    count_x_ = high_x - low_x_ + 1;
    count_y_ = high_y - low_y_ + 1;
    is_there_.assign(static_cast<std::size_t>(count_x_) * count_y_, 0);
    for (const std::uint32_t span : piece)
      is_there_[static_cast<std::size_t>(columns.y_of(span) - low_y_) * count_x_ + columns.x_of(span) -
                low_x_] = 1;
  }

  Lines best(const std::vector<double>& angles) const {
    struct Costed {
      double cost = kInfinity;
      std::uint32_t phase = 0;
    };
    std::vector<Costed> costed(angles.size());
    tbb::parallel_for(std::size_t{0}, angles.size(), [&](std::size_t i) {
      Lines lines(angles[i]);
      for (lines.phase = 0; lines.phase < pitch_; ++lines.phase) {
        const double cost = cost_of(lines, costed[i].cost);
        if (cost < costed[i].cost) costed[i] = {cost, lines.phase};
      }
    });
    std::size_t best = 0;
    for (std::size_t i = 1; i < angles.size(); ++i)
      if (costed[i].cost < costed[best].cost) best = i;
    Lines lines(angles[best]);
    lines.phase = costed[best].phase;
    return lines;
  }

  std::vector<RidgeRun> runs(const Lines& lines) const {
    struct On {
      std::int64_t line;
      std::uint32_t major;
      std::uint32_t span;
      double off;
    };
    std::vector<On> on;
    std::unordered_map<std::uint32_t, std::size_t> index;
    for (const std::uint32_t span : piece_) {
      if (!(own_[span] > close_)) continue;
      const auto [line, off] = nearest_line(lines, span);
      if (!is_on(lines, off)) continue;
      on.push_back({line, lines.is_along_x() ? columns_.x_of(span) : columns_.y_of(span), span, off});
    }
    std::ranges::sort(on, {}, [](const On& o) { return std::tuple(o.line, o.major, o.span); });
    for (std::size_t i = 0; i < on.size(); ++i) index[on[i].span] = i;
    std::vector<std::uint8_t> is_done(on.size(), 0);
    std::vector<RidgeRun> runs;
    for (std::size_t i = 0; i < on.size(); ++i) {
      if (is_done[i] != 0) continue;
      RidgeRun run;
      double farthest = 0;
      for (std::size_t at = i; at != on.size();) {
        is_done[at] = 1;
        farthest = std::max(farthest, with_edges_[on[at].span]);
        run.points.push_back(point_at(columns_, on_line(lines, on[at].span, on[at].off), on[at].span));
        std::size_t onward = on.size();
        for (const int aside : {0, 1, -1}) {
          const std::uint32_t other = lines.is_along_x() ? columns_.next(on[at].span, 1, aside)
                                                         : columns_.next(on[at].span, aside, 1);
          if (other == kNoSpan) continue;
          const auto found = index.find(other);
          if (found == index.end() || is_done[found->second] != 0 || on[found->second].line != on[at].line)
            continue;
          onward = found->second;
          break;
        }
        at = onward;
      }
      // One beside an edge holds nothing that the edge's own does not.
      if (farthest > close_) runs.push_back(std::move(run));
    }
    return runs;
  }

 private:
  // The line nearest to a span's column, and how far the column is from it, across.
  std::pair<std::int64_t, double> nearest_line(const Lines& lines, std::uint32_t span) const {
    const At at = at_column(columns_, span);
    const double across = at.x * lines.across.x + at.y * lines.across.y - lines.phase;
    const double line = std::floor(across / pitch_ + 0.5);
    return {static_cast<std::int64_t>(line), across - line * pitch_};
  }
  static bool is_on(const Lines& lines, double off) { return off >= -lines.half() && off < lines.half(); }
  // Where a line passes a column.
  At on_line(const Lines& lines, std::uint32_t span, double off) const {
    const At at = at_column(columns_, span);
    return lines.is_along_x() ? At{at.x, at.y - off / lines.across.y} : At{at.x - off / lines.across.x, at.y};
  }
  // Length of ridges, in columns, and what would have to be held besides; no less than `least` will do.
  double cost_of(const Lines& lines, double least) const {
    constexpr double kMissed = 0.5;  // columns of ridge for each that lines miss
    double cost = 0;
    for (const std::uint32_t span : piece_) {
      const bool is_missable = with_edges_[span] > reach_;
      if (!is_missable && !(own_[span] > close_)) continue;
      const double off = nearest_line(lines, span).second;
      if (own_[span] > close_ && is_on(lines, off)) cost += lines.length_of_a_column();
      if (is_missable && !is_near(lines, span, off)) cost += kMissed;
      if (cost >= least) return cost;
    }
    return cost;
  }
  bool is_near(const Lines& lines, std::uint32_t span, double off) const {
    const At at = at_column(columns_, span);
    for (const double there : {off, off - pitch_, off + pitch_}) {
      if (std::abs(there) * columns_.spacing > reach_) continue;
      const double x = std::floor(at.x - there * lines.across.x + 0.5) - low_x_;
      const double y = std::floor(at.y - there * lines.across.y + 0.5) - low_y_;
      if (x < 0 || y < 0 || x >= count_x_ || y >= count_y_) continue;
      if (is_there_[static_cast<std::size_t>(y) * count_x_ + static_cast<std::size_t>(x)] != 0) return true;
    }
    return false;
  }

  const Undersides& columns_;
  const std::vector<std::uint32_t>& piece_;
  const std::vector<double>&own_, &with_edges_;
  double close_, reach_;
  std::uint32_t pitch_;
  std::uint32_t low_x_ = 0, low_y_ = 0, count_x_ = 0, count_y_ = 0;
  std::vector<std::uint8_t> is_there_;  // columns of the piece's box
};

}  // namespace

std::vector<RidgeRun> edge_ridges(const Undersides& columns, const std::vector<std::uint32_t>& edges) {
  std::vector<RidgeRun> runs;
  for (const Chain& chain : Chains(columns, edges).trace(edges)) add_straightened(columns, chain, runs);
  return runs;
}

std::vector<RidgeRun> parallel_ridges(const Undersides& columns, const std::vector<std::uint32_t>& piece,
                                      const std::vector<RidgeRun>& edges, const std::vector<double>& own,
                                      const std::vector<double>& with_edges, double close, double reach) {
  const LineChoice choice(columns, piece, own, with_edges, close, reach);
  return choice.runs(choice.best(angles_to_try(columns, edges)));
}

}  // namespace aerate
