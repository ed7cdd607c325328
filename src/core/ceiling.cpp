#include "core/ceiling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <queue>

#include "core/disjoint_sets.h"
#include "core/upright.h"

namespace aerate {
namespace {

constexpr double kPrecision = 1e-3;  // of a disc's diameter, mm

using Point = PointFromAbove;

// Which facets are flat enough.
class Flatness {
 public:
  explicit Flatness(const Roof& roof) : up_(roof.up) {
    constexpr double kMargin = kCeilingMarginDegrees * std::numbers::pi / 180;
    least_ = roof.sine * std::cos(kMargin) + roof.cosine * std::sin(kMargin);
    any_ = roof.cosine * std::cos(kMargin) > roof.sine * std::sin(kMargin);  // else beyond the level
  }

  // Of an inward shell: its normals point into the void.
  bool is_ceiling(const Mesh& mesh, const Triangle& t) const {
    const Vec3d a = to_double(mesh.positions[t[0]]);
    const Vec3d normal = cross(to_double(mesh.positions[t[1]]) - a, to_double(mesh.positions[t[2]]) - a);
    const double down = -dot(normal, up_);
    return any_ && down > 0 && down >= least_ * length(normal);
  }

 private:
  Vec3d up_;
  double least_ = 1;
  bool any_ = true;
};

struct Edge {
  std::uint32_t low, high;
  std::uint32_t from, to;
  std::uint32_t facet;
};

// Distance from the rim, negative outside of it (even-odd rule).
double depth_in(const Ceiling& ceiling, Point p) {
  double nearest_squared = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (const auto& [a, b] : ceiling.rim) {
    const double ex = b.x - a.x, ey = b.y - a.y, px = p.x - a.x, py = p.y - a.y;
    const double extent = ex * ex + ey * ey;
    const double along = extent > 0 ? std::clamp((px * ex + py * ey) / extent, 0.0, 1.0) : 0.0;
    const double dx = px - along * ex, dy = py - along * ey;
    nearest_squared = std::min(nearest_squared, dx * dx + dy * dy);
    if ((a.y > p.y) != (b.y > p.y) && px < ex * py / ey) inside = !inside;
  }
  return inside ? std::sqrt(nearest_squared) : -std::sqrt(nearest_squared);
}

struct Square {
  Point centre;
  double half;
  double bound;  // of the depth within

  bool operator<(const Square& other) const { return bound < other.bound; }
};

// Radius of the largest disc, if that is more than `known` by the precision; else `known`. Squares that may
// hold a better centre are quartered, the most promising first.
double largest_disc(const Ceiling& ceiling, double known) {
  double x0 = std::numeric_limits<double>::infinity(), y0 = x0, x1 = -x0, y1 = -x0;
  for (const auto& [a, b] : ceiling.rim) {
    x0 = std::min({x0, a.x, b.x});
    x1 = std::max({x1, a.x, b.x});
    y0 = std::min({y0, a.y, b.y});
    y1 = std::max({y1, a.y, b.y});
  }
  if (!(x1 > x0) || !(y1 > y0)) return known;
  double best = known;
  std::priority_queue<Square> squares;
  const auto add = [&](Point centre, double half) {
    const double depth = depth_in(ceiling, centre);
    best = std::max(best, depth);
    squares.push({centre, half, depth + half * std::numbers::sqrt2});
  };
  add({0.5 * (x0 + x1), 0.5 * (y0 + y1)}, 0.5 * std::max(x1 - x0, y1 - y0));
  while (!squares.empty() && squares.top().bound > best + kPrecision / 2) {
    const Square square = squares.top();
    squares.pop();
    const double half = square.half / 2;
    for (const double x : {-half, half})
      for (const double y : {-half, half}) add({square.centre.x + x, square.centre.y + y}, half);
  }
  return best;
}

}  // namespace

double Ceiling::bound() const {
  return 2 * std::sqrt(area / std::numbers::pi);
}

std::vector<Ceiling> ceilings_of(const Mesh& mesh, std::span<const Triangle> shell, const Roof& roof) {
  const Flatness flatness(roof);
  const UprightFrame frame(roof.up);
  std::vector<Triangle> facets;
  for (const Triangle& t : shell)
    if (flatness.is_ceiling(mesh, t)) facets.push_back(t);
  std::vector<Edge> edges;
  edges.reserve(3 * facets.size());
  for (std::uint32_t i = 0; i < facets.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = facets[i][k], to = facets[i][(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from, to, i});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::array<std::size_t, 3>{a.low, a.high, a.facet} <
           std::array<std::size_t, 3>{b.low, b.high, b.facet};
  });

  DisjointSets sets(facets.size());  // of facets that share edges
  std::vector<Edge> rim;
  for (std::size_t i = 0; i < edges.size();) {
    const bool is_shared =
        i + 1 < edges.size() && edges[i].low == edges[i + 1].low && edges[i].high == edges[i + 1].high;
    if (is_shared) {
      sets.join(edges[i].facet, edges[i + 1].facet);
    } else {
      rim.push_back(edges[i]);
    }
    i += is_shared ? 2 : 1;
  }

  std::vector<Ceiling> ceilings;
  std::vector<std::size_t> number(facets.size());  // by the first facet of its set
  const auto seen = [&](std::uint32_t vertex) {
    const Vec3d p = frame.to_frame(to_double(mesh.positions[vertex]));
    return Point{p.x, p.y};
  };
  for (std::uint32_t i = 0; i < facets.size(); ++i) {
    if (sets.root(i) == i) {
      number[i] = ceilings.size();
      ceilings.emplace_back();
    }
    const Point a = seen(facets[i][0]), b = seen(facets[i][1]), c = seen(facets[i][2]);
    ceilings[number[sets.root(i)]].area +=
        0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  }
  for (const Edge& edge : rim)
    ceilings[number[sets.root(edge.facet)]].rim.push_back({seen(edge.from), seen(edge.to)});
  return ceilings;
}

double widest_disc(const Ceiling& ceiling, double known) {
  return 2 * largest_disc(ceiling, known / 2);
}

}  // namespace aerate
