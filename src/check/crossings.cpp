#include "check/crossings.h"

#include <array>
#include <cstdint>
#include <map>
#include <tbb/parallel_for.h>
#include <vector>

#include "check/check_failure.h"
#include "check/tube_cut.h"
#include "core/listed.h"
#include "mesh/inspect.h"

namespace aerate {
namespace {

// How far round a hole triangles are looked at, mm.
constexpr double kNeighbourhood = 0.5;

Mesh part_of(const Mesh& mesh, const std::vector<std::uint32_t>& indices) {
  std::vector<Triangle> triangles;
  triangles.reserve(indices.size());
  for (const std::uint32_t i : indices) triangles.push_back(mesh.triangles[i]);
  return submesh(mesh, triangles);
}

}  // namespace

bool is_crossed_near(const Mesh& model, const SurfaceIndex& surface, const Tube& tube) {
  const Mesh part = part_of(model, surface.triangles_near(cut_of(tube), tube.radius + kNeighbourhood));
  return find_self_intersections(part).pair_count > 0;
}

bool is_crossed_at(const OuterWithHoles& outer, std::size_t hole, const Tube& tube) {
  Mesh part = part_of(outer.mesh, triangles_near(outer.mesh, cut_of(tube), tube.radius + kNeighbourhood));
  const OuterWithHoles::Hole& cut = outer.holes[hole];
  // The part has vertices of its own: those of the sides are found among them by their place.
  std::map<std::array<float, 3>, std::uint32_t> index_of;
  for (std::uint32_t v = 0; v < part.positions.size(); ++v) {
    const Vec3f p = part.positions[v];
    index_of.emplace(std::array{p.x, p.y, p.z}, v);
  }
  const auto index = [&](std::uint32_t v) {
    const Vec3f p = v < cut.ring_base ? outer.mesh.positions[v] : cut.ring[v - cut.ring_base];
    const auto [place, is_new] =
        index_of.emplace(std::array{p.x, p.y, p.z}, static_cast<std::uint32_t>(part.positions.size()));
    if (is_new) part.positions.push_back(p);
    return place->second;
  };
  for (const Triangle& t : cut.sides) part.triangles.push_back({index(t[0]), index(t[1]), index(t[2])});
  return find_self_intersections(part).pair_count > 0;
}

void require_no_crossings(const Mesh& read_back, const DrainagePlan& plan) {
  std::vector<SelfIntersections> crossings(plan.holes.size());
  tbb::parallel_for(std::size_t{0}, plan.holes.size(), [&](std::size_t i) {
    const Tube& tube = plan.holes[i].tube;
    crossings[i] = find_self_intersections(
        part_of(read_back, triangles_near(read_back, cut_of(tube), tube.radius + kNeighbourhood)));
  });
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    if (crossings[i].pair_count == 0) continue;
    const Vec3d place = crossings[i].places.front();
    fail_check(
        "{} at escape hole {}, the first near ({:.3f}, {:.3f}, {:.3f}) mm",
        counted(crossings[i].pair_count, "pair of triangles intersects", "pairs of triangles intersect"), i,
        place.x, place.y, place.z);
  }
}

}  // namespace aerate
