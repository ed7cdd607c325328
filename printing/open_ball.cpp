#include "printing/open_ball.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/constants.h"

namespace aerate {
namespace {

// Half of an edge and a margin: see `open_ball`.
constexpr double kFreeShareOfEdge = 0.6;

double longest_edge(std::span<const Vec3d> ring) {
  double longest = 0;
  for (std::size_t i = 0; i < ring.size(); ++i)
    longest = std::max(longest, length(ring[(i + 1) % ring.size()] - ring[i]));
  return longest;
}

// Is the point within `margin` of the middle of an edge of an opening's rim?
bool is_near_rim(Vec3d point, const Opening& opening, double margin) {
  const Vec3d along = opening.tube.end - opening.tube.start;
  const Vec3d axis = normalised(along);
  const Vec3d from_start = point - opening.tube.start;
  const double from_axis = length(from_start - axis * dot(from_start, axis));
  // The rim is on the tube: most points are told apart by that.
  if (std::abs(from_axis - opening.tube.radius) >= 2 * margin) return false;
  const std::vector<Vec3d>& ring = opening.ring;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3d middle = (ring[i] + ring[(i + 1) % ring.size()]) * 0.5;
    if (length_squared(point - middle) < margin * margin) return true;
  }
  return false;
}

class BallOpener {
 public:
  BallOpener(const Sphere& ball, const StarTriangulation& whole, std::span<const Opening> openings)
      : ball_(ball), openings_(openings), triangulation_(whole) {}

  bool take_out_what_is_near_rims() {
    std::vector<double> margins;
    for (const Opening& opening : openings_) margins.push_back(kFreeShareOfEdge * longest_edge(opening.ring));
    const auto count = static_cast<std::uint32_t>(triangulation_.positions().size());
    for (std::uint32_t v = 0; v < count; ++v) {
      const Vec3d point = on_ball(triangulation_.positions()[v]);
      bool is_near = false;
      for (std::size_t i = 0; i < openings_.size() && !is_near; ++i)
        is_near = is_near_rim(point, openings_[i], margins[i]);
      if (!is_near) {
        kept_.push_back(v);
      } else if (!triangulation_.remove(v)) {
        return false;
      }
    }
    triangulation_.flip_to_hull();
    return !kept_.empty();
  }

  bool put_in_rings() {
    std::uint32_t last = kept_.front();
    for (const Opening& opening : openings_) {
      std::vector<std::uint32_t> ring;
      for (const Vec3d p : opening.ring) {
        const Vec3d from_centre = p - ball_.centre;
        const auto vertex = triangulation_.insert(normalised(from_centre), last);
        if (!vertex) return false;
        triangulation_.flip_to_hull_around(*vertex);
        ring.push_back(last = *vertex);
      }
      rings_.push_back(std::move(ring));
    }
    return true;
  }

  // What is left outside the rings; nullopt if one of them is no polygon of edges, or holds another.
  std::optional<OpenedBall> outside() {
    if (!mark_inside()) return std::nullopt;
    OpenedBall opened;
    const std::span<const Vec3d> directions = triangulation_.positions();
    std::vector<std::uint32_t> renumbered(directions.size(), kNone);
    const auto number = [&](std::uint32_t vertex, Vec3d position) {
      renumbered[vertex] = static_cast<std::uint32_t>(opened.positions.size());
      opened.positions.push_back(position);
    };
    for (std::size_t i = 0; i < rings_.size(); ++i) {
      for (std::size_t k = 0; k < rings_[i].size(); ++k) number(rings_[i][k], openings_[i].ring[k]);
    }
    std::vector<bool> is_used(directions.size(), false);
    const std::span<const Triangle> triangles = triangulation_.triangles();
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (const std::uint32_t v : triangles[t]) is_used[v] = is_used[v] || !is_inside_[t];
    }
    for (const std::uint32_t v : kept_) {
      if (is_used[v]) number(v, on_ball(directions[v]));
    }
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (is_inside_[t]) continue;
      Triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k) triangle[k] = renumbered[triangles[t][k]];
      std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
      opened.triangles.push_back(triangle);
    }
    // The order of flips is nothing to rely on.
    std::sort(opened.triangles.begin(), opened.triangles.end());
    return opened;
  }

 private:
  Vec3d on_ball(Vec3d direction) const { return ball_.centre + direction * ball_.radius; }

  // Marks the triangles inside the rings. False unless these are discs, apart from each other.
  bool mark_inside() {
    const std::size_t count = triangulation_.triangles().size();
    is_inside_.assign(count, false);
    std::vector<bool> is_rim(3 * count, false);
    std::vector<std::uint32_t> open;
    for (const std::vector<std::uint32_t>& ring : rings_) {
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const auto edge = triangulation_.half_edge(ring[k], ring[(k + 1) % ring.size()]);
        if (!edge) return false;
        is_rim[*edge] = true;
        if (!is_inside_[*edge / 3]) open.push_back(*edge / 3);
        is_inside_[*edge / 3] = true;
      }
    }
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t next = triangulation_.twin(h) / 3;
        if (is_rim[h] || is_inside_[next]) continue;
        is_inside_[next] = true;
        open.push_back(next);
      }
    }
    // From outside no rim is crossed: a triangle beyond one would be that of another ring.
    for (std::uint32_t h = 0; h < is_rim.size(); ++h) {
      if (is_rim[h] && is_inside_[triangulation_.twin(h) / 3]) return false;
    }
    return true;
  }

  Sphere ball_;
  std::span<const Opening> openings_;
  StarTriangulation triangulation_;
  std::vector<std::uint32_t> kept_;  // of the vertices that it came with
  std::vector<std::vector<std::uint32_t>> rings_;
  std::vector<bool> is_inside_;  // by triangle
};

double nearest_plane(const OpenedBall& opened, Vec3d centre) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : opened.triangles) {
    const Vec3d a = opened.positions[t[0]];
    const Vec3d normal = cross(opened.positions[t[1]] - a, opened.positions[t[2]] - a);
    nearest = std::min(nearest, dot(normal, a - centre) / length(normal));
  }
  return nearest;
}

}  // namespace

std::optional<OpenedBall> open_ball(const Sphere& ball, const StarTriangulation& whole,
                                    std::span<const Opening> openings) {
  BallOpener opener(ball, whole, openings);
  if (!opener.take_out_what_is_near_rims() || !opener.put_in_rings()) return std::nullopt;
  auto opened = opener.outside();
  if (opened) opened->nearest = nearest_plane(*opened, ball.centre);
  return opened;
}

}  // namespace aerate
