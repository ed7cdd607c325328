#include "packing/air/air_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tbb/parallel_for.h>
#include <utility>

#include "kernels/facet.h"

namespace aerate {
namespace {

// No column stands on a coordinate that people choose: parts of a spacing.
constexpr double kOffGridX = 0.4142, kOffGridY = 0.3179;

// Lower spans, and openings between surfaces that are as near as this, are rounding. Millimetres.
constexpr double kLeastHeight = 1e-5;

struct AirCrossing {
  double height;
  int leaves;  // +1: out of the solid, going up; -1: into it
};

double height_at(const kernels::Facet& facet, double x, double y) {
  const Vec3d a = to_double(facet.a), b = to_double(facet.b), c = to_double(facet.c);
  const Vec3d normal = cross(b - a, c - a);
  const double least = std::min({a.z, b.z, c.z}), most = std::max({a.z, b.z, c.z});
  const double height = a.z - (normal.x * (x - a.x) + normal.y * (y - a.y)) / normal.z;
  return std::isfinite(height) ? std::clamp(height, least, most) : least;
}

// Pairs of neighbouring columns: along x, along y, and along both diagonals. In coordinates u and v the line
// between the columns of a pair runs along v, from one whole number to the next, at a whole u.
constexpr int kFamilies = 4;

struct PairFrame {
  const AirColumns& columns;
  int family;

  // x and y in columns
  double u(double x, double y) const {
    return family == 0 ? y : family == 1 ? x : family == 2 ? x - y : x + y;
  }
  double v(double x, double y) const { return family == 1 ? y : x; }
  std::pair<int, int> from(int u, int v) const {
    switch (family) {
      case 0:
        return {v, u};
      case 1:
        return {u, v};
      case 2:
        return {v, v - u};
      default:
        return {v, u - v};
    }
  }
  std::pair<int, int> step() const {
    constexpr std::array<std::pair<int, int>, kFamilies> kSteps{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
    return kSteps[static_cast<std::size_t>(family)];
  }
  bool holds(int x, int y) const {
    return x >= 0 && y >= 0 && x < static_cast<int>(columns.count_x) && y < static_cast<int>(columns.count_y);
  }
};

// Heights that a piece of surface takes between two columns.
struct Obstacle {
  double lower, upper;
};

struct PairPoint {
  double u, v, z;
};

// Calls f(column, obstacle) for every pair whose plane a triangle crosses, by the pair's first column.
template <typename F>
void for_each_obstacle(const PairFrame& frame, const std::array<PairPoint, 3>& corners, const F& f) {
  const double least = std::min({corners[0].u, corners[1].u, corners[2].u});
  const double most = std::max({corners[0].u, corners[1].u, corners[2].u});
  for (int plane = static_cast<int>(std::ceil(least)); plane <= static_cast<int>(std::floor(most)); ++plane) {
    std::array<PairPoint, 2> ends{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const PairPoint &a = corners[i], &b = corners[(i + 1) % 3];
      if ((a.u <= plane) == (b.u <= plane) || count == 2) continue;
      const double share = (plane - a.u) / (b.u - a.u);
      ends[count++] = {0, a.v + share * (b.v - a.v), a.z + share * (b.z - a.z)};
    }
    if (count < 2) continue;
    if (ends[0].v > ends[1].v) std::swap(ends[0], ends[1]);
    const double length = ends[1].v - ends[0].v;
    const auto height = [&](double v) {
      const double share = length > 0 ? std::clamp((v - ends[0].v) / length, 0.0, 1.0) : 0;
      return ends[0].z + share * (ends[1].z - ends[0].z);
    };
    for (int i = static_cast<int>(std::floor(ends[0].v)); i <= static_cast<int>(std::floor(ends[1].v)); ++i) {
      const auto [x, y] = frame.from(plane, i);
      if (!frame.holds(x, y)) continue;
      const double a = length > 0 ? height(i) : ends[0].z, b = length > 0 ? height(i + 1) : ends[1].z;
      f(frame.columns.column(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)),
        Obstacle{std::min(a, b), std::max(a, b)});
    }
  }
}

// By the first column of each pair of a family.
class Obstacles {
 public:
  Obstacles(const Mesh& mesh, const PairFrame& frame) {
    const AirColumns& columns = frame.columns;
    const auto corners_of = [&](const Triangle& t) {
      std::array<PairPoint, 3> corners{};
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d p = to_double(mesh.positions[t[i]]);
        const double x = (p.x - columns.origin_x) / columns.spacing;
        const double y = (p.y - columns.origin_y) / columns.spacing;
        corners[i] = {frame.u(x, y), frame.v(x, y), p.z};
      }
      return corners;
    };
    first_.assign(static_cast<std::size_t>(columns.count_x) * columns.count_y + 1, 0);
    for (const Triangle& t : mesh.triangles)
      for_each_obstacle(frame, corners_of(t), [&](std::size_t column, Obstacle) { ++first_[column + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    all_.resize(first_.back());
    std::vector<std::size_t> next = first_;
    for (const Triangle& t : mesh.triangles)
      for_each_obstacle(frame, corners_of(t),
                        [&](std::size_t column, Obstacle obstacle) { all_[next[column]++] = obstacle; });
    tbb::parallel_for(std::size_t{0}, first_.size() - 1, [&](std::size_t column) {
      const std::span<Obstacle> own =
          std::span(all_).subspan(first_[column], first_[column + 1] - first_[column]);
      std::sort(own.begin(), own.end(),
                [](const Obstacle& a, const Obstacle& b) { return a.lower < b.lower; });
    });
  }

  std::span<const Obstacle> of(std::size_t column) const {
    return std::span(all_).subspan(first_[column], first_[column + 1] - first_[column]);
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<Obstacle> all_;
};

// What is free between `lower` and `upper`; false if nothing is. Obstacles ascend by their lower ends.
bool find_free(std::span<const Obstacle> obstacles, double lower, double upper, AirPassage& passage) {
  bool is_free = false;
  const auto take = [&](double from, double to) {
    if (to - from <= kLeastHeight) return;
    if (!is_free) passage.lowest = from;
    passage.highest = to;
    is_free = true;
  };
  double at = lower;
  for (const Obstacle& obstacle : obstacles) {
    if (obstacle.lower >= upper) break;
    if (obstacle.lower > at) take(at, obstacle.lower);
    at = std::max(at, obstacle.upper);
  }
  if (at < upper) take(at, upper);
  return is_free;
}

struct Join {
  std::uint32_t from;
  AirPassage passage;
};

// Between the spans of the columns of each pair, row by row.
std::vector<Join> joins_of(const AirColumns& columns, const Mesh& mesh, int family) {
  const PairFrame frame{columns, family};
  const Obstacles obstacles(mesh, frame);
  const std::pair<int, int> step = frame.step();
  std::vector<std::vector<Join>> by_row(columns.count_y);
  tbb::parallel_for(std::uint32_t{0}, columns.count_y, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < columns.count_x; ++x) {
      const int other_x = static_cast<int>(x) + step.first, other_y = static_cast<int>(y) + step.second;
      if (!frame.holds(other_x, other_y)) continue;
      const std::size_t here = columns.column(x, y);
      const std::size_t there =
          columns.column(static_cast<std::uint32_t>(other_x), static_cast<std::uint32_t>(other_y));
      std::uint32_t a = columns.first[here], b = columns.first[there];
      while (a < columns.first[here + 1] && b < columns.first[there + 1]) {
        const double lower = std::max(columns.spans[a].floor, columns.spans[b].floor);
        const double upper = std::min(columns.spans[a].ceiling, columns.spans[b].ceiling);
        AirPassage passage{b, lower, upper};
        if (lower < upper && find_free(obstacles.of(here), lower, upper, passage))
          by_row[y].push_back({a, passage});
        columns.spans[a].ceiling < columns.spans[b].ceiling ? ++a : ++b;
      }
    }
  });
  std::vector<Join> joins;
  for (const std::vector<Join>& row : by_row) joins.insert(joins.end(), row.begin(), row.end());
  return joins;
}

void add_passages(AirColumns& columns, const std::vector<Join>& joins) {
  columns.first_passage.assign(columns.spans.size() + 1, 0);
  for (const Join& join : joins) {
    ++columns.first_passage[join.from + 1];
    ++columns.first_passage[join.passage.to + 1];
  }
  std::partial_sum(columns.first_passage.begin(), columns.first_passage.end(), columns.first_passage.begin());
  columns.passages.resize(columns.first_passage.back());
  std::vector<std::size_t> next = columns.first_passage;
  for (const Join& join : joins) {
    columns.passages[next[join.from]++] = join.passage;
    AirPassage back = join.passage;
    back.to = join.from;
    columns.passages[next[join.passage.to]++] = back;
  }
}

void add_spans(AirColumns& columns, const kernels::WindingView& winding) {
  std::vector<std::vector<AirSpan>> by_column(static_cast<std::size_t>(columns.count_x) * columns.count_y);
  tbb::parallel_for(std::uint32_t{0}, columns.count_y, [&](std::uint32_t y) {
    for (std::uint32_t x = 0; x < columns.count_x; ++x)
      by_column[columns.column(x, y)] = air_spans_at(winding, columns.origin_x + columns.spacing * x,
                                                     columns.origin_y + columns.spacing * y);
  });
  columns.first.assign(1, 0);
  for (std::size_t i = 0; i < by_column.size(); ++i) {
    columns.spans.insert(columns.spans.end(), by_column[i].begin(), by_column[i].end());
    columns.column_of.resize(columns.spans.size(), static_cast<std::uint32_t>(i));
    columns.first.push_back(static_cast<std::uint32_t>(columns.spans.size()));
  }
}

}  // namespace

std::vector<AirSpan> air_spans_at(const kernels::WindingView& winding, double x, double y) {
  const Box3d& box = winding.box;
  if (x < box.lower.x || x > box.upper.x || y < box.lower.y || y > box.upper.y) return {AirSpan{}};
  std::vector<AirCrossing> crossings;
  winding.for_each_near(x, y, [&](std::uint32_t i) {
    const int sign = kernels::winding_detail::line_crossing(winding.facets[i], x, y);
    if (sign != 0) crossings.push_back({height_at(winding.facets[i], x, y), sign});
  });
  std::stable_sort(crossings.begin(), crossings.end(),
                   [](const AirCrossing& a, const AirCrossing& b) { return a.height < b.height; });
  std::vector<AirSpan> spans;
  int inside = 0;
  double floor = -kInfinity;
  for (const AirCrossing& crossing : crossings) {
    const int next = inside - crossing.leaves;
    if (inside <= 0 && next > 0 && crossing.height > floor + kLeastHeight)
      spans.push_back({floor, crossing.height});
    if (inside > 0 && next <= 0) floor = crossing.height;
    inside = next;
  }
  spans.push_back({floor, kInfinity});
  return spans;
}

AirColumns air_columns(const Mesh& upright, const kernels::WindingView& winding, double spacing,
                       std::uint32_t margin) {
  const Box3d& box = winding.box;
  AirColumns columns;
  columns.spacing = spacing;
  columns.origin_x = box.lower.x - (margin + kOffGridX) * spacing;
  columns.origin_y = box.lower.y - (margin + kOffGridY) * spacing;
  const auto count = [&](double length) {
    return static_cast<std::uint32_t>(std::ceil(length / spacing)) + 2 * margin + 1;
  };
  columns.count_x = count(box.upper.x - box.lower.x);
  columns.count_y = count(box.upper.y - box.lower.y);
  add_spans(columns, winding);
  std::array<std::vector<Join>, kFamilies> of_family;
  tbb::parallel_for(0, kFamilies, [&](int family) {
    of_family[static_cast<std::size_t>(family)] = joins_of(columns, upright, family);
  });
  std::vector<Join> joins;
  for (const std::vector<Join>& more : of_family) joins.insert(joins.end(), more.begin(), more.end());
  add_passages(columns, joins);
  return columns;
}

}  // namespace aerate
