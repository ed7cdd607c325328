#include "mesh/inspect.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <vector>

#include "mesh/overlap.h"
#include "mesh/topology.h"

namespace aerate {
namespace {

struct Counts {
  std::size_t open_edges = 0;
  std::size_t misoriented_edges = 0;
  std::size_t non_manifold_edges = 0;
  std::size_t degenerate_triangles = 0;
  std::size_t duplicate_triangles = 0;

  friend Counts operator+(const Counts& a, const Counts& b) {
    return {a.open_edges + b.open_edges, a.misoriented_edges + b.misoriented_edges,
            a.non_manifold_edges + b.non_manifold_edges, a.degenerate_triangles + b.degenerate_triangles,
            a.duplicate_triangles + b.duplicate_triangles};
  }
};

template <typename F>
Counts sum_over(std::size_t count, const F& counts_of) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, 4096), Counts{},
      [&](const tbb::blocked_range<std::size_t>& range, Counts sum) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) counts_of(i, sum);
        return sum;
      },
      std::plus<Counts>());
}

// Among the uses of one edge, the triangles that repeat an earlier one. Each triangle is looked at once only:
// at the edge that leaves its lowest vertex.
std::size_t count_duplicates(const Mesh& mesh, std::uint32_t low, std::span<const EdgeUse> uses) {
  if (uses.size() < 2) return 0;
  std::vector<std::uint32_t> third_vertices;
  for (const EdgeUse& use : uses) {
    const Triangle& triangle = mesh.triangles[use.triangle()];
    const std::size_t corner = use.half_edge % 3;
    if (triangle[corner] != low || triangle[(corner + 2) % 3] <= low || has_repeated_vertex(triangle))
      continue;
    third_vertices.push_back(triangle[(corner + 2) % 3]);
  }
  std::sort(third_vertices.begin(), third_vertices.end());
  const auto different = std::unique(third_vertices.begin(), third_vertices.end()) - third_vertices.begin();
  return third_vertices.size() - static_cast<std::size_t>(different);
}

Counts count_flaws(const Mesh& mesh, const EdgeUses& uses) {
  const Counts edges = sum_over(uses.row_count(), [&](std::size_t row, Counts& sum) {
    uses.for_each_edge(row, [&](std::uint32_t low, std::uint32_t, std::span<const EdgeUse> edge) {
      const EdgeBalance balance = balance_of(mesh, low, edge);
      sum.open_edges += balance.is_open() ? 1u : 0u;
      sum.misoriented_edges += balance.is_misoriented() ? 1u : 0u;
      sum.non_manifold_edges += balance.is_non_manifold() ? 1u : 0u;
      sum.duplicate_triangles += count_duplicates(mesh, low, edge);
    });
  });
  const Counts triangles = sum_over(mesh.triangles.size(), [&](std::size_t t, Counts& sum) {
    sum.degenerate_triangles += has_no_area(mesh, mesh.triangles[t]) ? 1u : 0u;
  });
  return edges + triangles;
}

bool boxes_meet(const Box3f& a, const Box3f& b) {
  return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y &&
         b.lower.y <= a.upper.y && a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}

// Sweep along x. Stops at the first pair.
bool any_boxes_meet(const std::vector<Shell>& shells) {
  std::vector<const Box3f*> boxes;
  boxes.reserve(shells.size());
  for (const Shell& shell : shells) boxes.push_back(&shell.box);
  std::sort(boxes.begin(), boxes.end(),
            [](const Box3f* a, const Box3f* b) { return a->lower.x < b->lower.x; });
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t j = i + 1; j < boxes.size() && boxes[j]->lower.x <= boxes[i]->upper.x; ++j) {
      if (boxes_meet(*boxes[i], *boxes[j])) return true;
    }
  }
  return false;
}

// Bodies that share edges are one shell, and may lie in each other.
bool can_overlap(const Inspection& inspection) {
  const std::vector<Shell>& shells = inspection.shells;
  return inspection.non_manifold_edges > 0 ||
         std::any_of(shells.begin(), shells.end(), [](const Shell& shell) { return shell.volume < 0; }) ||
         any_boxes_meet(shells);
}

}  // namespace

Inspection inspect(const Mesh& mesh) {
  Inspection result;
  result.vertex_count = mesh.positions.size();
  result.triangle_count = mesh.triangles.size();
  result.box = bounding_box(mesh);
  result.volume = signed_volume(mesh);
  result.area = surface_area(mesh);
  result.filled_volume = result.volume;
  if (mesh.triangles.empty()) return result;

  const EdgeUses uses(mesh);
  const Counts flaws = count_flaws(mesh, uses);
  result.open_edges = flaws.open_edges;
  result.misoriented_edges = flaws.misoriented_edges;
  result.non_manifold_edges = flaws.non_manifold_edges;
  result.degenerate_triangles = flaws.degenerate_triangles;
  result.duplicate_triangles = flaws.duplicate_triangles;

  if (result.open_edges > 0) {
    for (const BoundaryChain& chain : chain_boundary(mesh, uses)) {
      result.boundary_loops.push_back(describe_loop(mesh, chain));
    }
  }
  std::stable_sort(result.boundary_loops.begin(), result.boundary_loops.end(),
                   [](const BoundaryLoop& a, const BoundaryLoop& b) { return a.diameter > b.diameter; });

  const ShellLabels labels = label_shells(mesh, uses);
  result.shells = describe_shells(mesh, labels);
  if (!result.closed()) find_open_shells(mesh, uses, labels, result.shells);
  // Winding numbers of a mesh that is not closed depend on the direction of the line.
  if (result.closed() && can_overlap(result)) {
    const Overlap overlap = measure_overlap(mesh, labels);
    result.overlapped_volume = overlap.volume;
    result.filled_volume = result.volume + overlap.filled_excess;
    result.overlapping_shells = overlap.shells;
  }
  std::stable_sort(result.shells.begin(), result.shells.end(),
                   [](const Shell& a, const Shell& b) { return std::abs(a.volume) > std::abs(b.volume); });
  return result;
}

}  // namespace aerate
