#include "check/check_sealed.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "check/check_failure.h"
#include "check/polled_loop.h"
#include "check/shell_topology.h"

namespace aerate {
namespace {

// Numbers of the vertices that triangles use: [lowest, end).
struct VertexRange {
  std::uint32_t lowest = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t end = 0;

  // Whether a shell that shares no vertex with those before it can have these.
  bool can_be_own(std::size_t triangle_count) const { return end - lowest <= 3 * triangle_count; }
};

VertexRange vertices_of(std::span<const Triangle> triangles) {
  VertexRange range;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t vertex : t) {
      range.lowest = std::min(range.lowest, vertex);
      range.end = std::max(range.end, vertex + 1);
    }
  }
  return range;
}

// What one void was found to be, for the messages to be given in order.
struct Finding {
  VertexRange vertices;
  std::optional<std::string> flaw;
};

Finding look_at(std::span<const Triangle> triangles) {
  Finding finding{vertices_of(triangles), std::nullopt};
  if (finding.vertices.can_be_own(triangles.size())) finding.flaw = flaw_of_sphere_shell(triangles);
  return finding;
}

}  // namespace

// A new surface: what inspection found out about it was before vertices at one place became one.
void require_sound_outer(const Mesh& read_back, const Expected& expected) {
  const Inspection found = inspect(submesh(read_back, triangles_of(read_back, expected.solid.parts.front())));
  if (found.open_edges > 0) fail_check("the outer surface has {} open edges", found.open_edges);
  if (found.misoriented_edges > 0)
    fail_check("the outer surface has {} misoriented edges", found.misoriented_edges);
  if (found.non_manifold_edges > expected.inspection.non_manifold_edges)
    fail_check("the outer surface has {} non-manifold edges, the model has {}", found.non_manifold_edges,
               expected.inspection.non_manifold_edges);
  if (found.volume <= 0) fail_check("the outer surface is inside out");
}

void check_sealed(const Mesh& read_back, const Expected& expected, Monitor& monitor) {
  if (expected.outer == OuterSurface::remeshed) require_sound_outer(read_back, expected);
  const std::span<const SolidPart> voids = expected.solid.of(PartKind::void_surface);
  std::vector<Finding> findings(voids.size());
  for_each_polled(voids.size(), kVoidsPerPiece, monitor,
                  [&](std::size_t i) { findings[i] = look_at(triangles_of(read_back, voids[i])); });

  // A shell that shares no vertex with what came before uses exactly the next numbers.
  std::uint32_t next_vertex = vertices_of(triangles_of(read_back, expected.solid.parts.front())).end;
  for (std::size_t i = 0; i < findings.size(); ++i) {
    if (findings[i].vertices.lowest < next_vertex) fail_check("void {} touches another surface", i);
    if (findings[i].flaw) fail_check("void {}: {}", i, *findings[i].flaw);
    next_vertex = std::max(next_vertex, findings[i].vertices.end);
  }
}

}  // namespace aerate
