#include "bench/unsupported_lines.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "printing/slicers/gcode_machine.h"
#include "printing/slicers/print_log.h"
#include "printing/slicers/text_file.h"

namespace aerate::bench {
namespace {

constexpr std::size_t kMostChords = 10'000;
// Heights are told apart to a hundredth of a millimetre; layers of one height may be off by rounding.
constexpr double kSameHeight = 0.021;
// Edge of the squares in which lines are looked for, mm.
constexpr double kSquare = 2;

LineKind kind_of(std::string_view type) {
  static const std::map<std::string_view, LineKind> kinds{{"Perimeter", LineKind::perimeter},
                                                          {"External perimeter", LineKind::perimeter},
                                                          {"Overhang perimeter", LineKind::perimeter},
                                                          {"Internal infill", LineKind::sparse},
                                                          {"Solid infill", LineKind::solid},
                                                          {"Top solid infill", LineKind::solid},
                                                          {"Gap fill", LineKind::solid},
                                                          {"Ironing", LineKind::solid},
                                                          {"Bridge infill", LineKind::bridge}};
  const auto known = kinds.find(type);
  return known == kinds.end() ? LineKind::other : known->second;
}

// A share of a line, from and to 0..1.
using Interval = std::pair<double, double>;

// Where a + b t is within [least, most], if it is anywhere.
std::optional<Interval> where_within(double a, double b, double least, double most) {
  constexpr double kEverywhere = 1e300;
  if (b == 0)
    return a >= least && a <= most ? std::optional<Interval>({-kEverywhere, kEverywhere}) : std::nullopt;
  const double one = (least - a) / b, other = (most - a) / b;
  return Interval{std::min(one, other), std::max(one, other)};
}

// Where a line is within `reach` of a point at (x, y) from its start.
std::optional<Interval> where_near_point(double dx, double dy, double x, double y, double reach) {
  const double square = dx * dx + dy * dy, half = x * dx + y * dy;
  const double root = half * half - square * (x * x + y * y - reach * reach);
  if (square == 0 || root < 0) return std::nullopt;
  return Interval{(half - std::sqrt(root)) / square, (half + std::sqrt(root)) / square};
}

// Where a line is within `reach` of another. That is one interval, since what is that near is convex: the
// rectangle along the other line and the discs at its ends.
std::optional<Interval> where_near(const ExtrusionMove& line, const ExtrusionMove& other, double reach) {
  const double dx = line.x - line.from_x, dy = line.y - line.from_y;
  const double sx = other.from_x - line.from_x, sy = other.from_y - line.from_y;
  const double ex = other.x - line.from_x, ey = other.y - line.from_y;
  std::optional<Interval> near = where_near_point(dx, dy, sx, sy, reach);
  const auto add = [&near](const std::optional<Interval>& more) {
    if (!more) return;
    near = near ? Interval{std::min(near->first, more->first), std::max(near->second, more->second)} : *more;
  };
  add(where_near_point(dx, dy, ex, ey, reach));
  const double length = std::hypot(ex - sx, ey - sy);
  if (length > 0) {
    const double ux = (ex - sx) / length, uy = (ey - sy) / length;
    const auto along = where_within(-(sx * ux + sy * uy), dx * ux + dy * uy, 0, length);
    const auto across = where_within(-(sx * uy - sy * ux), dx * uy - dy * ux, -reach, reach);
    if (along && across) {
      const Interval both{std::max(along->first, across->first), std::min(along->second, across->second)};
      if (both.first <= both.second) add(both);
    }
  }
  if (!near || near->second <= 0 || near->first >= 1) return std::nullopt;
  return Interval{std::max(near->first, 0.0), std::min(near->second, 1.0)};
}

// The lines of a layer, to be found by place.
class LayerLines {
 public:
  void add(const PrintedLine& line) {
    const std::size_t index = lines_.size();
    lines_.push_back(&line);
    for_each_square(line.move, line.width / 2,
                    [&](std::int64_t square) { squares_[square].push_back(index); });
  }

  // Where there is nothing of this layer within half of the line's width, as shares of it in order.
  std::vector<Interval> gaps_under(const PrintedLine& line) const {
    std::vector<std::size_t> candidates;
    for_each_square(line.move, line.width / 2, [&](std::int64_t square) {
      const auto found = squares_.find(square);
      if (found != squares_.end())
        candidates.insert(candidates.end(), found->second.begin(), found->second.end());
    });
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    std::vector<Interval> near;
    for (const std::size_t at : candidates) {
      const PrintedLine& other = *lines_[at];
      if (const auto interval = where_near(line.move, other.move, (line.width + other.width) / 2))
        near.push_back(*interval);
    }
    std::sort(near.begin(), near.end());
    std::vector<Interval> gaps;
    double covered = 0;
    for (const auto& [from, to] : near) {
      if (from > covered) gaps.emplace_back(covered, from);
      covered = std::max(covered, to);
    }
    if (covered < 1) gaps.emplace_back(covered, 1);
    return gaps;
  }

 private:
  // Squares that the box round the line meets; long lines in pieces, so that their boxes are small.
  template <typename F>
  static void for_each_square(const ExtrusionMove& move, double margin, const F& f) {
    const double length = std::hypot(move.x - move.from_x, move.y - move.from_y);
    const int pieces = static_cast<int>(std::min(1e6, std::ceil(length / kSquare)));
    for (int i = 0; i < pieces; ++i) {
      const auto at = [&](double from, double to, int k) { return from + (to - from) * k / pieces; };
      const double x0 = at(move.from_x, move.x, i), x1 = at(move.from_x, move.x, i + 1);
      const double y0 = at(move.from_y, move.y, i), y1 = at(move.from_y, move.y, i + 1);
      const auto first_row = square_of(std::min(y0, y1) - margin),
                 last_row = square_of(std::max(y0, y1) + margin);
      const auto first = square_of(std::min(x0, x1) - margin), last = square_of(std::max(x0, x1) + margin);
      for (std::int64_t row = first_row; row <= last_row; ++row)
        for (std::int64_t column = first; column <= last; ++column) f((row << 32) + column);
    }
  }
  static std::int64_t square_of(double place) {
    return static_cast<std::int64_t>(std::floor(place / kSquare));
  }

  std::vector<const PrintedLine*> lines_;
  std::unordered_map<std::int64_t, std::vector<std::size_t>> squares_;
};

}  // namespace

const char* name_of(LineKind kind) {
  switch (kind) {
    case LineKind::perimeter:
      return "perimeters";
    case LineKind::sparse:
      return "sparse";
    case LineKind::solid:
      return "solid";
    case LineKind::bridge:
      return "bridges";
    case LineKind::other:
      break;
  }
  return "other";
}

std::vector<PrintedLine> printed_lines(std::string_view gcode, double width, double height) {
  std::vector<PrintedLine> lines;
  std::vector<ExtrusionMove> moves;
  GcodeMachine machine;
  LineKind kind = LineKind::other;
  const auto read = [](std::string_view line, std::string_view key, double& value) {
    if (!line.starts_with(key)) return;
    line.remove_prefix(key.size());
    if (const auto number = take_number(line); number && *number > 0) value = *number;
  };
  for_each_line(gcode, [&](std::string_view line) {
    constexpr std::string_view kType = ";TYPE:";
    if (line.starts_with(kType)) kind = kind_of(without_blanks(line.substr(kType.size())));
    read(line, ";WIDTH:", width);
    read(line, ";HEIGHT:", height);
    if (!machine.run(line)) return true;
    moves.clear();
    machine.append_moves(moves, kMostChords);
    for (const ExtrusionMove& move : moves) lines.push_back({move, width, height, kind});
    return true;
  });
  return lines;
}

std::array<UnsupportedLength, kLineKinds.size()> unsupported_length(const std::vector<PrintedLine>& lines) {
  std::map<std::int64_t, LayerLines> layers;
  for (const PrintedLine& line : lines) layers[layer_at(line.move.z)].add(line);
  // Null on the bed.
  const auto layer_below = [&](const PrintedLine& line) -> const LayerLines* {
    const auto own = layers.find(layer_at(line.move.z));
    if (own == layers.begin()) return nullptr;
    if (line.kind == LineKind::bridge) return &std::prev(own)->second;
    const double begin = line.move.z - std::max(line.height - kSameHeight, kSameHeight);
    const auto above = layers.upper_bound(layer_at(begin));
    return above == layers.begin() ? nullptr : &std::prev(above)->second;
  };
  std::array<UnsupportedLength, kLineKinds.size()> result;
  const PrintedLine* before = nullptr;
  double way = 0;  // without anything below, up to the end of the line before
  for (const PrintedLine& line : lines) {
    const double length = std::hypot(line.move.x - line.move.from_x, line.move.y - line.move.from_y);
    if (length == 0) continue;
    UnsupportedLength& kind = result[static_cast<std::size_t>(line.kind)];
    kind.length += length;
    const bool goes_on = before != nullptr && before->kind == line.kind && before->move.z == line.move.z &&
                         before->move.x == line.move.from_x && before->move.y == line.move.from_y;
    if (!goes_on) way = 0;
    before = &line;
    const LayerLines* below = layer_below(line);
    const std::vector<Interval> gaps = below == nullptr ? std::vector<Interval>{} : below->gaps_under(line);
    double way_at_end = 0;
    for (const auto& [from, to] : gaps) {
      const double gap = (to - from) * length;
      const double so_far = gap + (from == 0 ? way : 0);
      kind.unsupported += gap;
      kind.longest = std::max(kind.longest, so_far);
      if (to == 1) way_at_end = so_far;
    }
    way = way_at_end;
  }
  return result;
}

}  // namespace aerate::bench
