#include "check/check_opened.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "check/check_failure.h"
#include "check/measure_errors.h"
#include "core/segment_distance.h"
#include "core/surface_index.h"
#include "mesh/topology.h"

namespace aerate {
namespace {

// How far round a hole triangles are looked at, mm.
constexpr double kNeighbourhood = 0.5;

// From where the cut at one end ends to where that at the other does.
Segment cut_through_by(const Tube& hole) {
  const Vec3d beyond = direction_of(hole) * (kCutBeyond * hole.radius);
  return {hole.start - beyond, hole.end + beyond};
}

std::int64_t euler_of(const Mesh& mesh) {
  std::vector<bool> is_used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) is_used[v] = true;
  }
  std::int64_t edges = 0;
  const EdgeUses uses(mesh);
  for (std::size_t low = 0; low < uses.row_count(); ++low)
    uses.for_each_edge(low, [&](std::uint32_t, std::uint32_t, std::span<const EdgeUse>) { ++edges; });
  return std::count(is_used.begin(), is_used.end(), true) - edges +
         static_cast<std::int64_t>(mesh.triangles.size());
}

bool is_cavity(const Shell& shell) {
  return shell.volume <= -kLeastCavity;
}

void require_sound(const ExpectedOpening& expected) {
  const Inspection& now = expected.opened_inspection;
  if (now.open_edges > 0) fail_check("with its cavities opened it has {} open edges", now.open_edges);
  if (now.misoriented_edges > 0)
    fail_check("with its cavities opened it has {} misoriented edges", now.misoriented_edges);
  if (now.non_manifold_edges > expected.inspection.non_manifold_edges)
    fail_check("with its cavities opened it has {} non-manifold edges, the model has {}",
               now.non_manifold_edges, expected.inspection.non_manifold_edges);
  const std::int64_t planned =
      euler_of(expected.model) - 2 * static_cast<std::int64_t>(expected.holes.size());
  if (const std::int64_t euler = euler_of(expected.opened); euler != planned)
    fail_check("its Euler characteristic is {} instead of {}: holes do not join its cavities to the outside",
               euler, planned);
  const auto sealed = std::ranges::count_if(now.shells, is_cavity);
  if (sealed > 0) fail_check("{} of its own cavities are sealed", sealed);
}

void require_within_holes(const ExpectedOpening& expected) {
  const std::vector<Vec3f>& before = expected.model.positions;
  const std::vector<Vec3f>& now = expected.opened.positions;
  if (now.size() < before.size() || !std::equal(before.begin(), before.end(), now.begin()))
    fail_check("a vertex of the model moved when its cavities were opened");
  const double rounding = kRoundingShare * std::max(1.0, largest_coordinate(expected.opened));
  for (std::size_t v = before.size(); v < now.size(); ++v) {
    const Vec3d p = to_double(now[v]);
    const bool is_within = std::ranges::any_of(expected.holes, [&](const Tube& hole) {
      return distance_to_point(cut_through_by(hole), p) <= hole.radius + rounding;
    });
    if (!is_within)
      fail_check("opening its cavities made a vertex outside of the holes, near ({:.3f}, {:.3f}, {:.3f}) mm",
                 p.x, p.y, p.z);
  }
  double most = 0;
  for (const Tube& hole : expected.holes) {
    const Segment cut = cut_through_by(hole);
    most += std::numbers::pi * hole.radius * hole.radius * length(cut.end - cut.start);
  }
  const double removed = signed_volume(expected.model) - signed_volume(expected.opened);
  const double error = kSummationError * std::abs(signed_volume(expected.model));
  if (removed < -error || removed > most + error)
    fail_check("holes of its cavities remove {:.9g} mm3, {:.9g} at most were planned", removed, most);
}

}  // namespace

bool is_crossed_along(const Mesh& mesh, const Tube& hole) {
  std::vector<Triangle> near;
  for (const std::uint32_t t : triangles_near(mesh, cut_through_by(hole), hole.radius + kNeighbourhood))
    near.push_back(mesh.triangles[t]);
  return find_self_intersections(submesh(mesh, near)).pair_count > 0;
}

void check_opened(const ExpectedOpening& expected, Monitor& monitor) {
  require_sound(expected);
  monitor.check_interrupted();
  require_within_holes(expected);
  for (const Tube& hole : expected.holes) {
    monitor.check_interrupted();
    if (is_crossed_along(expected.opened, hole))
      fail_check("triangles intersect near the hole of a cavity at ({:.3f}, {:.3f}, {:.3f}) mm", hole.end.x,
                 hole.end.y, hole.end.z);
  }
}

void require_no_sealed_cavity(const Mesh& read_back) {
  const std::vector<Shell> shells = describe_shells(read_back, label_shells(read_back, EdgeUses(read_back)));
  const auto sealed = std::ranges::count_if(shells, is_cavity);
  if (sealed > 0) fail_check("{} cavities are sealed", sealed);
}

}  // namespace aerate
