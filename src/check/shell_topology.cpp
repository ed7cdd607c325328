#include "check/shell_topology.h"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
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

// Number of triangles that can be reached from the first one across edges.
std::size_t count_connected(const std::vector<std::uint32_t>& twins) {
  std::vector<bool> is_reached(twins.size() / 3);
  std::vector<std::uint32_t> waiting{0};
  is_reached[0] = true;
  std::size_t count = 0;
  while (!waiting.empty()) {
    const std::uint32_t triangle = waiting.back();
    waiting.pop_back();
    ++count;
    for (std::uint32_t edge = 3 * triangle; edge < 3 * triangle + 3; ++edge) {
      const std::uint32_t neighbour = twins[edge] / 3;
      if (is_reached[neighbour]) continue;
      is_reached[neighbour] = true;
      waiting.push_back(neighbour);
    }
  }
  return count;
}

}  // namespace

std::optional<std::string> flaw_of_sphere_shell(std::span<const Triangle> triangles) {
  if (triangles.empty()) return "it has no triangles";
  for (const Triangle& t : triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return "a triangle uses a vertex twice";
  }

  // Closed, oriented and 2-manifold along its edges: each is run along exactly once in either direction.
  const DirectedEdges edges(triangles);
  std::vector<std::uint32_t> twins(3 * triangles.size());
  bool is_open = false;
  for (std::uint32_t e = 0; e < twins.size(); ++e) {
    if (edges.find(edges.start_of(e), edges.end_of(e)).count > 1)
      return "an edge has more than two triangles, or two that face opposite ways";
    const DirectedEdges::Found twin = edges.find(edges.end_of(e), edges.start_of(e));
    is_open = is_open || twin.count == 0;
    twins[e] = twin.edge;
  }
  if (is_open) return "it is open";

  // Connected across edges, not merely through vertices: then it is a sphere by Euler's formula, and no
  // vertex pinches it, since each that did would make the sum less.
  if (count_connected(twins) != triangles.size()) return "it is more than one shell";
  const auto euler = static_cast<std::ptrdiff_t>(edges.vertex_count() + triangles.size()) -
                     static_cast<std::ptrdiff_t>(twins.size() / 2);
  if (euler != 2) return fmt::format("its Euler characteristic is {} instead of 2", euler);
  return std::nullopt;
}

}  // namespace aerate
