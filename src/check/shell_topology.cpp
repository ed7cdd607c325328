#include "check/shell_topology.h"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "kernels/constants.h"

namespace aerate {
namespace {

// The directed edges of some triangles; edge 3 t + i runs from corner i of triangle t to the next one. A CSR
// over the vertices that edges begin at, numbered from the lowest.
class DirectedEdges {
 public:
  explicit DirectedEdges(std::span<const Triangle> triangles) : triangles_(triangles) {
    std::uint32_t highest = 0;
    for (const Triangle& t : triangles) {
      lowest_ = std::min({lowest_, t[0], t[1], t[2]});
      highest = std::max({highest, t[0], t[1], t[2]});
    }
    offsets_.resize(std::size_t{highest} - lowest_ + 2);
    for (const Triangle& t : triangles) {
      for (const std::uint32_t vertex : t) ++offsets_[vertex - lowest_ + 1];
    }
    for (std::size_t i = 1; i < offsets_.size(); ++i) {
      if (offsets_[i] > 0) ++vertex_count_;
      offsets_[i] += offsets_[i - 1];
    }
    edges_.assign(3 * triangles.size(), 0);
    std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
    for (std::uint32_t e = 0; e < edges_.size(); ++e) edges_[next[start_of(e) - lowest_]++] = e;
  }

  std::size_t vertex_count() const { return vertex_count_; }
  std::uint32_t start_of(std::uint32_t edge) const { return triangles_[edge / 3][edge % 3]; }
  std::uint32_t end_of(std::uint32_t edge) const { return triangles_[edge / 3][(edge % 3 + 1) % 3]; }

  // The edges from one vertex to another: how many, and the last of them.
  struct Found {
    std::size_t count = 0;
    std::uint32_t edge = kNone;
  };
  Found find(std::uint32_t from, std::uint32_t to) const {
    Found found;
    for (std::uint32_t i = offsets_[from - lowest_]; i != offsets_[from - lowest_ + 1]; ++i) {
      if (end_of(edges_[i]) != to) continue;
      ++found.count;
      found.edge = edges_[i];
    }
    return found;
  }

 private:
  std::span<const Triangle> triangles_;
  std::uint32_t lowest_ = kNone;
  std::size_t vertex_count_ = 0;
  std::vector<std::uint32_t> offsets_;
  std::vector<std::uint32_t> edges_;
};

// Sets of triangles that hang together across edges.
std::size_t count_shells(const std::vector<std::uint32_t>& twins) {
  std::vector<bool> is_reached(twins.size() / 3);
  std::vector<std::uint32_t> waiting;
  std::size_t count = 0;
  for (std::uint32_t first = 0; first < is_reached.size(); ++first) {
    if (is_reached[first]) continue;
    ++count;
    is_reached[first] = true;
    waiting.push_back(first);
    while (!waiting.empty()) {
      const std::uint32_t triangle = waiting.back();
      waiting.pop_back();
      for (std::uint32_t edge = 3 * triangle; edge < 3 * triangle + 3; ++edge) {
        const std::uint32_t neighbour = twins[edge] / 3;
        if (is_reached[neighbour]) continue;
        is_reached[neighbour] = true;
        waiting.push_back(neighbour);
      }
    }
  }
  return count;
}

// Fans of triangles about vertices. A vertex where surfaces only touch has more than one.
std::size_t count_fans(const std::vector<std::uint32_t>& twins) {
  std::vector<bool> is_seen(twins.size());
  std::size_t count = 0;
  for (std::uint32_t first = 0; first < twins.size(); ++first) {
    if (is_seen[first]) continue;
    ++count;
    for (std::uint32_t edge = first; !is_seen[edge];) {
      is_seen[edge] = true;
      const std::uint32_t before = edge % 3 == 0 ? edge + 2 : edge - 1;
      edge = twins[before];
    }
  }
  return count;
}

SurfaceTopology flawed(std::string flaw) {
  return {std::move(flaw), 0, 0, 0};
}

}  // namespace

SurfaceTopology topology_of(std::span<const Triangle> triangles) {
  if (triangles.empty()) return flawed("it has no triangles");
  for (const Triangle& t : triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return flawed("a triangle uses a vertex twice");
  }

  // Closed, oriented and 2-manifold along its edges: each is run along exactly once in either direction.
  const DirectedEdges edges(triangles);
  std::vector<std::uint32_t> twins(3 * triangles.size());
  bool is_open = false;
  for (std::uint32_t e = 0; e < twins.size(); ++e) {
    if (edges.find(edges.start_of(e), edges.end_of(e)).count > 1)
      return flawed("an edge has more than two triangles, or two that face opposite ways");
    const DirectedEdges::Found twin = edges.find(edges.end_of(e), edges.start_of(e));
    is_open = is_open || twin.count == 0;
    twins[e] = twin.edge;
  }
  if (is_open) return flawed("it is open");

  SurfaceTopology topology;
  topology.shell_count = count_shells(twins);
  topology.euler = static_cast<std::int64_t>(edges.vertex_count() + triangles.size()) -
                   static_cast<std::int64_t>(twins.size() / 2);
  // With a vertex for each fan, shells are closed oriented 2-manifolds, of an Euler characteristic of 2 at most each. A
  // pinch is one vertex less than that, so where the sum is the most there is none, and none is looked for.
  if (topology.euler < 2 * static_cast<std::int64_t>(topology.shell_count))
    topology.pinch_count = count_fans(twins) - edges.vertex_count();
  return topology;
}

std::optional<std::string> flaw_of_sphere_shell(std::span<const Triangle> triangles) {
  SurfaceTopology topology = topology_of(triangles);
  if (topology.flaw) return topology.flaw;
  if (topology.shell_count != 1) return "it is more than one shell";
  if (topology.euler != 2) return fmt::format("its Euler characteristic is {} instead of 2", topology.euler);
  return std::nullopt;
}

}  // namespace aerate
