#include "pipeline/shell_topology.h"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <numeric>
#include <utility>
#include <vector>

namespace aerate {
namespace {

std::uint64_t directed_edge(std::uint32_t from, std::uint32_t to) {
  return (static_cast<std::uint64_t>(from) << 32) | to;
}

// Number of sets that the edges join the vertices 0..vertex_count-1 into.
std::size_t count_components(std::span<const std::array<std::uint32_t, 3>> triangles,
                             std::size_t vertex_count) {
  std::vector<std::uint32_t> parent(vertex_count);
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root_of = [&](std::uint32_t vertex) {
    while (parent[vertex] != vertex) vertex = parent[vertex] = parent[parent[vertex]];
    return vertex;
  };
  std::size_t components = vertex_count;
  for (const auto& triangle : triangles) {
    for (const int corner : {1, 2}) {
      const std::uint32_t a = root_of(triangle[0]);
      const std::uint32_t b = root_of(triangle[static_cast<std::size_t>(corner)]);
      if (a == b) continue;
      parent[std::max(a, b)] = std::min(a, b);
      --components;
    }
  }
  return components;
}

}  // namespace

std::optional<std::string> flaw_of_sphere_shell(std::span<const Triangle> triangles) {
  if (triangles.empty()) return "it has no triangles";

  std::vector<std::uint32_t> vertices;
  vertices.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) vertices.insert(vertices.end(), t.begin(), t.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());

  std::vector<Triangle> local(triangles.begin(), triangles.end());
  for (Triangle& t : local) {
    for (std::uint32_t& vertex : t) {
      vertex = static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), vertex) -
                                          vertices.begin());
    }
  }

  // Closed, oriented and 2-manifold along its edges: each is run along exactly once in either direction.
  std::vector<std::uint64_t> forward;
  std::vector<std::uint64_t> backward;
  forward.reserve(3 * local.size());
  backward.reserve(3 * local.size());
  for (const Triangle& t : local) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = t[i];
      const std::uint32_t to = t[(i + 1) % 3];
      if (from == to) return "a triangle uses a vertex twice";
      forward.push_back(directed_edge(from, to));
      backward.push_back(directed_edge(to, from));
    }
  }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  if (std::adjacent_find(forward.begin(), forward.end()) != forward.end())
    return "an edge has more than two triangles, or two that face opposite ways";
  if (forward != backward) return "it is open";

  if (count_components(local, vertices.size()) != 1) return "it is more than one shell";
  const auto euler = static_cast<std::ptrdiff_t>(vertices.size() + local.size()) -
                     static_cast<std::ptrdiff_t>(forward.size() / 2);
  if (euler != 2) return fmt::format("its Euler characteristic is {} instead of 2", euler);
  return std::nullopt;
}

}  // namespace aerate
