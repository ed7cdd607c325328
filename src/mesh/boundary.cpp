#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "kernels/constants.h"
#include "mesh/topology.h"

namespace aerate {
namespace {

// Walks along open edges from vertex to vertex. Where a walk comes back to a vertex it has visited, the loop
// is cut off as a chain of its own.
class BoundaryWalk {
 public:
  BoundaryWalk(std::vector<OpenEdge> edges, std::size_t vertex_count)
      : edges_(std::move(edges)),
        used_(edges_.size(), false),
        place_on_path_(edges_.empty() ? 0 : vertex_count, kNone) {
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      ends_.emplace_back(edges_[e].from, e);
      ends_.emplace_back(edges_[e].to, e);
    }
    std::sort(ends_.begin(), ends_.end());
  }

  std::vector<BoundaryChain> chains() {
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (!used_[e]) walk_from(edges_[e].from);
    }
    return std::move(chains_);
  }

 private:
  void walk_from(std::uint32_t start) {
    path_.clear();
    step_to(start);
    while (const auto next = take_edge_at(path_.back())) {
      const std::uint32_t place = place_on_path_[*next];
      if (place == kNone) {
        step_to(*next);
      } else {
        cut_off(place, true);
        step_to(*next);
        if (place == 0) break;
      }
    }
    if (path_.size() > 1) {
      cut_off(0, false);
    } else {
      place_on_path_[path_.front()] = kNone;
    }
  }

  void step_to(std::uint32_t vertex) {
    place_on_path_[vertex] = static_cast<std::uint32_t>(path_.size());
    path_.push_back(vertex);
  }

  void cut_off(std::uint32_t place, bool closed) {
    const auto first = path_.begin() + place;
    chains_.push_back({{first, path_.end()}, closed});
    for (auto vertex = first; vertex != path_.end(); ++vertex) place_on_path_[*vertex] = kNone;
    path_.erase(first, path_.end());
  }

  // The other end of an edge at `vertex` that was not used yet: along its direction if there is one (the
  // triangles at a hole may disagree about orientation).
  std::optional<std::uint32_t> take_edge_at(std::uint32_t vertex) {
    const auto begin = std::lower_bound(ends_.begin(), ends_.end(), std::pair{vertex, std::uint32_t{0}});
    std::uint32_t against = kNone;
    for (auto end = begin; end != ends_.end() && end->first == vertex; ++end) {
      const std::uint32_t e = end->second;
      if (used_[e]) continue;
      if (edges_[e].from == vertex) {
        used_[e] = true;
        return edges_[e].to;
      }
      if (against == kNone) against = e;
    }
    if (against == kNone) return std::nullopt;
    used_[against] = true;
    return edges_[against].from;
  }

  std::vector<OpenEdge> edges_;
  std::vector<bool> used_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends_;  // vertex, edge
  std::vector<std::uint32_t> path_, place_on_path_;
  std::vector<BoundaryChain> chains_;
};

}  // namespace

std::vector<OpenEdge> open_edges(const Mesh& mesh, const EdgeUses& uses) {
  std::vector<OpenEdge> open;
  for (std::size_t row = 0; row < uses.row_count(); ++row) {
    uses.for_each_edge(row, [&](std::uint32_t low, std::uint32_t high, std::span<const EdgeUse> edge) {
      const EdgeBalance balance = balance_of(mesh, low, edge);
      if (!balance.is_open()) return;
      open.push_back(balance.forward == 1 ? OpenEdge{high, low} : OpenEdge{low, high});
    });
  }
  return open;
}

std::vector<BoundaryChain> chain_boundary(const Mesh& mesh, const EdgeUses& uses) {
  return BoundaryWalk(open_edges(mesh, uses), mesh.positions.size()).chains();
}

BoundaryLoop describe_loop(const Mesh& mesh, const BoundaryChain& chain) {
  BoundaryLoop loop;
  loop.edge_count = chain.vertices.size() - (chain.closed ? 0 : 1);
  Box3f box{mesh.positions[chain.vertices.front()], mesh.positions[chain.vertices.front()]};
  Vec3d sum{0, 0, 0};
  for (const std::uint32_t vertex : chain.vertices) {
    const Vec3f p = mesh.positions[vertex];
    box.lower = min_of(box.lower, p);
    box.upper = max_of(box.upper, p);
    sum = sum + to_double(p);
  }
  loop.centre = sum * (1.0 / static_cast<double>(chain.vertices.size()));
  loop.diameter = diagonal_of(box);
  return loop;
}

}  // namespace aerate
