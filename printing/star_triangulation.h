#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "kernels/vec.h"

namespace aerate {

// A closed triangulation all of whose triangles face away from the origin, that can be changed edge by edge
// and vertex by vertex. Half-edge 3 t + k runs from corner k to corner k + 1 of triangle t, which is on its
// left; twins run between the same vertices.
class StarTriangulation {
 public:
  StarTriangulation(std::vector<Vec3d> positions, std::vector<Triangle> triangles)
      : positions_(std::move(positions)), triangles_(std::move(triangles)) {}

  // False unless closed, 2-manifold, connected and of genus 0.
  bool connect() {
    const std::size_t edges = 3 * triangles_.size() / 2;
    if (triangles_.empty() || positions_.size() + triangles_.size() != edges + 2) return false;
    if (!pair_half_edges() || !is_connected()) return false;
    out_.resize(positions_.size());
    for (std::uint32_t h = 0; h < 3 * triangles_.size(); ++h) out_[start(h)] = h;
    return true;
  }

  // Flips edges that lie below the surface's convex hull until none is left: each flip adds volume.
  void flip_to_hull() {
    std::vector<std::uint32_t> unchecked;
    unchecked.reserve(3 * triangles_.size());
    for (std::uint32_t h = 0; h < 3 * triangles_.size(); ++h) unchecked.push_back(h);
    flip_to_hull(std::move(unchecked));
  }

  // The same where edges beside a vertex may lie below the hull, and nowhere else.
  void flip_to_hull_around(std::uint32_t vertex) {
    std::vector<std::uint32_t> unchecked;
    for_each_out(vertex, [&](std::uint32_t h) { unchecked.insert(unchecked.end(), {h, next(h)}); });
    flip_to_hull(std::move(unchecked));
  }

  // Moves every vertex to the unit vector along the sum of its triangles' area vectors, each weighted by a
  // power of the triangle's sagitta. Power 0 puts the vertex where the volume is largest with all others
  // fixed, because the volume is linear in it; higher powers pull it towards the deepest triangles.
  void spread(int power) {
    sort_stars();
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      Vec3d sum{0, 0, 0};
      for (std::uint32_t i = star_offsets_[v]; i < star_offsets_[v + 1]; ++i) {
        const auto [a, b, c] = corners(star_triangles_[i]);
        const Vec3d area = cross(b - a, c - a);
        const double depth = std::max(0.0, 1 - dot(area, a) / length(area));
        sum = sum + area * (power == 0 ? 1.0 : power == 1 ? depth : depth * depth);
      }
      positions_[v] = normalised(sum);
    }
  }

  // Splits the triangle that the ray from the centre through `position` meets into three at a new vertex
  // there, and returns its number; nullopt if the ray meets an edge. The search begins at the vertex `near`.
  std::optional<std::uint32_t> insert(Vec3d position, std::uint32_t near = 0) {
    if (const auto t = walk_towards(position, out_[near] / 3)) return split(*t, position);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (is_within(t, position)) return split(t, position);
    }
    return std::nullopt;
  }

  // Takes a vertex out of all triangles, of which there are then two less; its position stays in the list.
  // False if the triangulation would not be left star-shaped.
  bool remove(std::uint32_t vertex) {
    while (true) {
      std::size_t degree = 0;
      std::optional<std::uint32_t> flippable;
      for_each_out(vertex, [&](std::uint32_t h) {
        ++degree;
        if (!flippable && is_flippable(h)) flippable = h;
      });
      if (degree == 3) break;
      if (!flippable) return false;
      flip(*flippable);
    }
    const std::uint32_t first = out_[vertex], third = next_out(first), second = next_out(third);
    if (!(volume(positions_[start(next(first))], positions_[start(next(second))],
                 positions_[start(next(third))]) > 0))
      return false;
    merge(next(first), next(second), next(third));
    return true;
  }

  std::uint32_t twin(std::uint32_t half_edge) const { return twins_[half_edge]; }
  // The half-edge from one vertex to another, if they are neighbours.
  std::optional<std::uint32_t> half_edge(std::uint32_t from, std::uint32_t to) const {
    std::optional<std::uint32_t> found;
    for_each_out(from, [&](std::uint32_t h) {
      if (start(next(h)) == to) found = h;
    });
    return found;
  }

  std::span<const Vec3d> positions() const { return positions_; }
  std::span<const Triangle> triangles() const { return triangles_; }

  std::array<Vec3d, 3> corners(std::uint32_t triangle) const {
    const Triangle& t = triangles_[triangle];
    return {positions_[t[0]], positions_[t[1]], positions_[t[2]]};
  }

 private:
  std::uint32_t start(std::uint32_t half_edge) const { return triangles_[half_edge / 3][half_edge % 3]; }

  // The half-edge out of the same vertex that comes next, clockwise.
  std::uint32_t next_out(std::uint32_t half_edge) const { return next(twins_[half_edge]); }

  template <typename Visit>
  void for_each_out(std::uint32_t vertex, Visit visit) const {
    std::uint32_t h = out_[vertex];
    do {
      visit(h);
      h = next_out(h);
    } while (h != out_[vertex]);
  }

  void flip_to_hull(std::vector<std::uint32_t> unchecked) {
    while (!unchecked.empty()) {
      const std::uint32_t h = unchecked.back();
      unchecked.pop_back();
      if (!is_below_hull(h) || !is_flippable(h)) continue;
      const std::uint32_t g = twins_[h];
      flip(h);
      for (const std::uint32_t side : {h, next(h), next(next(h)), g, next(g), next(next(g))}) {
        unchecked.push_back(side);
      }
    }
  }

  // A side of the triangle beyond which the ray through `position` meets the surface.
  std::optional<std::uint32_t> crossed_side(std::uint32_t t, Vec3d position) const {
    const auto [a, b, c] = corners(t);
    if (volume(a, b, position) < 0) return 3 * t;
    if (volume(b, c, position) < 0) return 3 * t + 1;
    if (volume(c, a, position) < 0) return 3 * t + 2;
    return std::nullopt;
  }

  bool is_within(std::uint32_t t, Vec3d position) const {
    const auto [a, b, c] = corners(t);
    return volume(a, b, position) > 0 && volume(b, c, position) > 0 && volume(c, a, position) > 0;
  }

  // From triangle to triangle to the one that the ray meets; nullopt if that takes too long or it meets an
  // edge.
  std::optional<std::uint32_t> walk_towards(Vec3d position, std::uint32_t t) const {
    for (std::size_t step = 0; step < triangles_.size(); ++step) {
      const auto side = crossed_side(t, position);
      if (!side) return is_within(t, position) ? std::optional(t) : std::nullopt;
      t = twins_[*side] / 3;
    }
    return std::nullopt;
  }

  // Six times the volume between the centre and a triangle, positive if that faces outward.
  static double volume(Vec3d a, Vec3d b, Vec3d c) { return dot(cross(a, b), c); }

  bool pair_half_edges() {
    struct Side {
      std::uint64_t edge;
      std::uint32_t half_edge;
    };
    std::vector<Side> sides(3 * triangles_.size());
    for (std::uint32_t h = 0; h < sides.size(); ++h) {
      const std::uint64_t from = start(h), to = start(next(h));
      sides[h] = {std::min(from, to) << 32 | std::max(from, to), h};
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return a.edge != b.edge ? a.edge < b.edge : a.half_edge < b.half_edge;
    });
    twins_.resize(sides.size());
    for (std::size_t i = 0; i < sides.size(); i += 2) {
      if (i + 1 == sides.size() || sides[i].edge != sides[i + 1].edge) return false;
      if (i + 2 < sides.size() && sides[i + 2].edge == sides[i].edge) return false;
      const std::uint32_t g = sides[i].half_edge, h = sides[i + 1].half_edge;
      if (start(g) == start(h)) return false;
      twins_[g] = h;
      twins_[h] = g;
    }
    return true;
  }

  bool is_connected() const {
    std::vector<bool> reached(triangles_.size());
    std::vector<std::uint32_t> unvisited{0};
    reached[0] = true;
    std::size_t count = 1;
    while (!unvisited.empty()) {
      const std::uint32_t t = unvisited.back();
      unvisited.pop_back();
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t neighbour = twins_[h] / 3;
        if (reached[neighbour]) continue;
        reached[neighbour] = true;
        ++count;
        unvisited.push_back(neighbour);
      }
    }
    return count == triangles_.size();
  }

  bool is_below_hull(std::uint32_t h) const {
    const auto [a, b, c] = corners(h / 3);
    const Vec3d opposite = positions_[start(next(next(twins_[h])))];
    const Vec3d area = cross(b - a, c - a);
    return dot(area, opposite - a) > kFlat * length_squared(area);
  }

  // Would both triangles after the flip face outward? On a sphere always.
  bool is_flippable(std::uint32_t h) const {
    const auto [a, b, c] = corners_from(h);
    const Vec3d d = positions_[start(next(next(twins_[h])))];
    return volume(a, d, c) > 0 && volume(b, c, d) > 0;
  }

  std::array<Vec3d, 3> corners_from(std::uint32_t h) const {
    return {positions_[start(h)], positions_[start(next(h))], positions_[start(next(next(h)))]};
  }

  std::uint32_t split(std::uint32_t t, Vec3d position) {
    const auto v = static_cast<std::uint32_t>(positions_.size());
    positions_.push_back(position);
    const auto [a, b, c] = triangles_[t];
    const std::uint32_t twin_bc = twins_[3 * t + 1], twin_ca = twins_[3 * t + 2];
    const auto second = static_cast<std::uint32_t>(3 * triangles_.size()), third = second + 3;
    triangles_[t] = {a, b, v};
    triangles_.push_back({b, c, v});
    triangles_.push_back({c, a, v});
    twins_.resize(3 * triangles_.size());
    pair(second, twin_bc);
    pair(third, twin_ca);
    pair(3 * t + 1, second + 2);
    pair(second + 1, third + 2);
    pair(third + 1, 3 * t + 2);
    out_.push_back(3 * t + 2);
    out_[b] = second;
    out_[c] = third;
    return v;
  }

  // Makes one triangle of the three around a vertex, of which these half-edges, one after the other, are the
  // outer sides.
  void merge(std::uint32_t first, std::uint32_t second, std::uint32_t third) {
    const std::array<std::uint32_t, 3> twins{twins_[first], twins_[second], twins_[third]};
    const std::uint32_t t = first / 3;
    const Triangle merged{start(first), start(second), start(third)};
    triangles_[t] = merged;
    for (std::uint32_t k = 0; k < 3; ++k) {
      pair(3 * t + k, twins[k]);
      out_[merged[k]] = 3 * t + k;
    }
    drop(std::max(second / 3, third / 3));
    drop(std::min(second / 3, third / 3));
  }

  // Takes a triangle out of the list, which nothing refers to; the last takes its place.
  void drop(std::uint32_t t) {
    const auto last = static_cast<std::uint32_t>(triangles_.size() - 1);
    if (t != last) {
      triangles_[t] = triangles_[last];
      for (std::uint32_t k = 0; k < 3; ++k) {
        pair(3 * t + k, twins_[3 * last + k]);
        out_[triangles_[t][k]] = 3 * t + k;
      }
    }
    triangles_.pop_back();
    twins_.resize(3 * triangles_.size());
  }

  // a -> b with c on its left and d on its right becomes d -> c; the four outer sides keep their twins.
  void flip(std::uint32_t h) {
    const std::uint32_t g = twins_[h];
    const std::uint32_t bc = next(h), ca = next(bc), ad = next(g), db = next(ad);
    const std::uint32_t c = start(ca), d = start(db);
    const std::uint32_t twin_bc = twins_[bc], twin_ad = twins_[ad];
    // Half-edge h becomes a -> d, bc becomes d -> c; g becomes b -> c, ad becomes c -> d.
    triangles_[bc / 3][bc % 3] = d;
    triangles_[ad / 3][ad % 3] = c;
    pair(h, twin_ad);
    pair(g, twin_bc);
    pair(bc, ad);
    out_[start(h)] = h;
    out_[start(g)] = g;
    out_[d] = bc;
    out_[c] = ad;
  }

  void pair(std::uint32_t g, std::uint32_t h) {
    twins_[g] = h;
    twins_[h] = g;
  }

  // The triangles around each vertex in CSR form.
  void sort_stars() {
    star_offsets_.assign(positions_.size() + 1, 0);
    star_triangles_.resize(3 * triangles_.size());
    for (const Triangle& t : triangles_) {
      for (const std::uint32_t v : t) ++star_offsets_[v];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& offset : star_offsets_) offset = sum += offset;
    for (std::uint32_t i = static_cast<std::uint32_t>(triangles_.size()); i-- > 0;) {
      for (const std::uint32_t v : triangles_[i]) star_triangles_[--star_offsets_[v]] = i;
    }
  }

  // Height of a vertex above its neighbour's plane, over twice that triangle's area, that counts as flat.
  // Exact symmetry gives 0, curvature about 1/2 on the unit sphere.
  static constexpr double kFlat = 1e-9;

  static constexpr std::uint32_t next(std::uint32_t half_edge) {
    return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
  }

  std::vector<Vec3d> positions_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> twins_;
  std::vector<std::uint32_t> out_;  // by vertex: a half-edge that leads out of it
  std::vector<std::uint32_t> star_offsets_, star_triangles_;
};

}  // namespace aerate
