#include "printing/open_ball.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

namespace aerate {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

// Half of an edge and a margin: see `open_ball`.
constexpr double kFreeShareOfEdge = 0.6;

double longest_edge(std::span<const Vec3d> ring) {
  double longest = 0;
  for (std::size_t i = 0; i < ring.size(); ++i)
    longest = std::max(longest, length(ring[(i + 1) % ring.size()] - ring[i]));
  return longest;
}

// Is the point of the sphere inside the opening, or too near to its rim?
bool is_near(Vec3d point, const Sphere& ball, const Opening& opening, double margin) {
  const Vec3d along = opening.tube.end - opening.tube.start;
  const Vec3d axis = along * (1 / length(along));
  const double side = dot(point - ball.centre, axis);
  if ((opening.end == TubeEnd::start) != (side > 0)) return false;
  const Vec3d from_start = point - opening.tube.start;
  return length(from_start - axis * dot(from_start, axis)) < opening.tube.radius + margin;
}

// Triangles of the convex hull by the points' indices; empty if some point is not a corner of it.
std::vector<Triangle> hull_of(const std::vector<Vec3d>& positions) {
  std::vector<Point> points;
  std::map<Point, std::uint32_t> index_of;
  for (const Vec3d p : positions) {
    points.emplace_back(p.x, p.y, p.z);
    index_of.emplace(points.back(), static_cast<std::uint32_t>(index_of.size()));
  }
  CGAL::Surface_mesh<Point> hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  if (index_of.size() != points.size() || hull.number_of_vertices() != points.size()) return {};
  std::vector<Triangle> triangles;
  for (const auto face : hull.faces()) {
    Triangle triangle{};
    std::size_t corner = 0;
    for (const auto vertex : hull.vertices_around_face(hull.halfedge(face))) {
      if (corner == 3) return {};
      triangle[corner++] = index_of.at(hull.point(vertex));
    }
    triangles.push_back(triangle);
  }
  // The hull's own order depends on its history alone, but ours is easier to rely on.
  for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

std::uint64_t directed_edge(std::uint32_t from, std::uint32_t to) {
  return static_cast<std::uint64_t>(from) << 32 | to;
}

// Removes the triangles inside the rings, which are `sizes` consecutive vertices each. False if an edge of a
// ring is no edge of the hull.
bool remove_inside(std::vector<Triangle>& triangles, std::span<const std::size_t> sizes) {
  std::unordered_map<std::uint64_t, std::uint32_t> triangle_at;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t corner = 0; corner < 3; ++corner)
      triangle_at[directed_edge(triangles[i][corner], triangles[i][(corner + 1) % 3])] = i;
  }
  std::unordered_map<std::uint64_t, bool> is_rim;
  std::vector<std::uint32_t> open;
  std::vector<bool> is_inside(triangles.size(), false);
  std::uint32_t first = 0;
  std::size_t expected = 0;
  for (const std::size_t size : sizes) {
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::uint32_t from = first + i;
      const std::uint32_t to = first + (i + 1) % static_cast<std::uint32_t>(size);
      const auto found = triangle_at.find(directed_edge(from, to));
      if (found == triangle_at.end()) return false;
      is_rim[directed_edge(from, to)] = true;
      if (!is_inside[found->second]) open.push_back(found->second);
      is_inside[found->second] = true;
    }
    first += static_cast<std::uint32_t>(size);
    expected += size - 2;
  }
  std::size_t count = 0;
  while (!open.empty()) {
    const Triangle t = triangles[open.back()];
    open.pop_back();
    ++count;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t from = t[corner], to = t[(corner + 1) % 3];
      if (is_rim.contains(directed_edge(from, to))) continue;
      const std::uint32_t next = triangle_at.at(directed_edge(to, from));
      if (!is_inside[next]) open.push_back(next);
      is_inside[next] = true;
    }
  }
  if (count != expected) return false;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!is_inside[i]) triangles[kept++] = triangles[i];
  }
  triangles.resize(kept);
  return true;
}

}  // namespace

std::optional<OpenedBall> open_ball(const Sphere& ball, std::span<const Vec3d> directions,
                                    std::span<const Opening> openings) {
  OpenedBall opened;
  std::vector<std::size_t> sizes;
  std::vector<double> margins;
  for (const Opening& opening : openings) {
    opened.positions.insert(opened.positions.end(), opening.ring.begin(), opening.ring.end());
    sizes.push_back(opening.ring.size());
    margins.push_back(kFreeShareOfEdge * longest_edge(opening.ring));
  }
  for (const Vec3d direction : directions) {
    const Vec3d point = ball.centre + direction * ball.radius;
    bool is_free = true;
    for (std::size_t i = 0; i < openings.size() && is_free; ++i)
      is_free = !is_near(point, ball, openings[i], margins[i]);
    if (is_free) opened.positions.push_back(point);
  }
  opened.triangles = hull_of(opened.positions);
  if (opened.triangles.empty() || !remove_inside(opened.triangles, sizes)) return std::nullopt;
  opened.nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : opened.triangles) {
    const Vec3d a = opened.positions[t[0]];
    const Vec3d normal = cross(opened.positions[t[1]] - a, opened.positions[t[2]] - a);
    opened.nearest = std::min(opened.nearest, dot(normal, a - ball.centre) / length(normal));
  }
  return opened;
}

}  // namespace aerate
