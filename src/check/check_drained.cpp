#include "check/check_drained.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>
#include <vector>

#include "check/check_failure.h"
#include "check/crossings.h"
#include "check/tube_cut.h"
#include "kernels/constants.h"
#include "mesh/outward_shells.h"
#include "mesh/topology.h"

namespace aerate {
namespace {

// Where a hole has come out, as far from the surface as it is wide.
Vec3d mouth_of(const Tube& tube) {
  return tube.end + direction_of(tube) * tube.radius;
}

// Edges by kind, and vertices - edges + triangles.
struct EdgeCounts {
  std::size_t open = 0, misoriented = 0, non_manifold = 0;
  std::int64_t euler = 0;

  EdgeCounts operator+(const EdgeCounts& other) const {
    return {open + other.open, misoriented + other.misoriented, non_manifold + other.non_manifold,
            euler + other.euler};
  }
};
EdgeCounts count_edges(const Mesh& mesh, const EdgeUses& uses) {
  std::vector<bool> is_used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) is_used[v] = true;
  }
  EdgeCounts without_edges;
  without_edges.euler =
      std::count(is_used.begin(), is_used.end(), true) + static_cast<std::int64_t>(mesh.triangles.size());
  const auto add_edges = [&](const tbb::blocked_range<std::size_t>& rows, EdgeCounts counts) {
    for (std::size_t low = rows.begin(); low != rows.end(); ++low) {
      uses.for_each_edge(low, [&](std::uint32_t from, std::uint32_t, std::span<const EdgeUse> edge) {
        const EdgeBalance balance = balance_of(mesh, from, edge);
        counts.open += balance.is_open() ? 1U : 0U;
        counts.misoriented += balance.is_misoriented() ? 1U : 0U;
        counts.non_manifold += balance.is_non_manifold() ? 1U : 0U;
        --counts.euler;
      });
    }
    return counts;
  };
  return without_edges + tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, uses.row_count()),
                                              EdgeCounts{}, add_edges, std::plus<>());
}

// What is found out about edges and shells as wholes.
struct Topology {
  EdgeCounts edges, edges_of_model;
  ShellLabels labels;
  std::vector<Shell> shells;
};
Topology find_topology(const Mesh& read_back, const Mesh& model) {
  Topology topology;
  const EdgeUses uses(read_back);
  tbb::parallel_invoke([&] { topology.edges = count_edges(read_back, uses); },
                       [&] { topology.edges_of_model = count_edges(model, EdgeUses(model)); },
                       [&] {
                         topology.labels = label_shells(read_back, uses);
                         topology.shells = describe_shells(read_back, topology.labels);
                       });
  return topology;
}

void require_sound_edges(const Topology& topology, const Expected& expected) {
  const EdgeCounts& counts = topology.edges;
  const EdgeCounts& model = topology.edges_of_model;
  if (counts.open > 0) fail_check("it has {} open edges", counts.open);
  if (counts.misoriented > 0) fail_check("it has {} misoriented edges", counts.misoriented);
  if (counts.non_manifold > model.non_manifold)
    fail_check("it has {} non-manifold edges, the model has {}", counts.non_manifold, model.non_manifold);
  // A void adds its own (a ball 2); a tube takes a disc at either end (-2), and is a cylinder (0).
  const DrainagePlan& plan = *expected.drainage;
  const auto tubes = static_cast<std::int64_t>(plan.channels.size() + plan.holes.size());
  auto voids = 2 * static_cast<std::int64_t>(expected.packing.spheres.size());
  if (expected.cells != nullptr) {
    voids = 0;
    for (const CellVoid& piece : expected.cells->voids) voids += piece.euler;
  }
  const std::int64_t planned = model.euler + voids - 2 * tubes;
  if (counts.euler != planned)
    fail_check(
        "its Euler characteristic is {} instead of {}: voids, channels and holes do not join as planned",
        counts.euler, planned);
}

// Shells with inner surface that are inward, so that nothing joins them to the outside; and holes that open
// into a cavity of the model.
std::size_t count_sealed(const Mesh& read_back, const Topology& topology, const Expected& expected) {
  const ShellLabels& labels = topology.labels;
  std::vector<bool> is_sealed(labels.count, false), reaches_outside(labels.count, false);
  for (std::size_t i = 0; i < expected.solid.outer_triangle_count(); ++i) {
    if (labels.of_triangle[i] != kNone) reaches_outside[labels.of_triangle[i]] = true;
  }
  for (std::size_t i = expected.solid.outer_triangle_count(); i < read_back.triangles.size(); ++i) {
    const std::uint32_t label = labels.of_triangle[i];
    if (label == kNone) fail_check("triangle {} belongs to no shell", i);
    if (topology.shells[label].volume <= 0) {
      is_sealed[label] = true;
    } else if (!reaches_outside[label]) {
      fail_check("a void surrounds solid material, which would be loose (triangle {})", i);
    }
  }
  const std::vector<EscapeHole>& holes = expected.drainage->holes;
  const OutwardShells outward(expected.model, expected.inspection, expected.surface);
  const auto is_shut_in = [&](const EscapeHole& hole) {
    return outward.winding().winding_number(mouth_of(hole.tube)) != 0;
  };
  return static_cast<std::size_t>(std::count(is_sealed.begin(), is_sealed.end(), true) +
                                  std::count_if(holes.begin(), holes.end(), is_shut_in));
}

}  // namespace

std::size_t check_drained(const Mesh& read_back, const Expected& expected, Monitor& monitor) {
  const Topology topology = find_topology(read_back, expected.model);
  require_sound_edges(topology, expected);
  monitor.check_interrupted();
  const std::size_t sealed = count_sealed(read_back, topology, expected);
  if (sealed > 0) fail_check("{} cavities are sealed", sealed);
  require_no_crossings(read_back, *expected.drainage);
  return sealed;
}

}  // namespace aerate
