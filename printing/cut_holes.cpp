#include "printing/cut_holes.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "printing/cut_surface.h"
#include "printing/tube_openings.h"

namespace aerate {
namespace {

// A prism begins this much inside its ball's surface, and ends beyond the model's by this many radii, mm.
constexpr double kPrismMargin = 0.02;
constexpr double kPrismBeyond = 1.8;

CuttingPrism prism_of(const WayOut& way, const Roof& roof, double tolerance) {
  const Tube& tube = way.tube;
  const Opening opening = opening_of(tube, TubeEnd::start, way.ball, roof, sides_of(tube, tolerance));
  const Vec3d along = tube.end - tube.start;
  CuttingPrism prism;
  prism.axis = along * (1 / length(along));
  prism.start = tube.start - prism.axis * kPrismMargin;
  prism.length = length(along) + kPrismMargin + kPrismBeyond * tube.radius;
  prism.radius = tube.radius;
  for (const Vec3d p : opening.ring) prism.ring.push_back(to_float(p));
  return prism;
}

// Without the elements at these places, ascending.
template <typename T>
void remove_at(std::vector<T>& values, std::span<const std::uint32_t> places) {
  std::size_t kept = 0, next = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (next < places.size() && places[next] == i) {
      ++next;
    } else {
      values[kept++] = values[i];
    }
  }
  values.resize(kept);
}

// What a cut leaves of a surface; its own triangles come last.
void apply(const SurfaceCut& cut, Mesh& mesh) {
  remove_at(mesh.triangles, cut.removed);
  mesh.triangles.insert(mesh.triangles.end(), cut.surface.begin(), cut.surface.end());
  mesh.positions.insert(mesh.positions.end(), cut.new_positions.begin(), cut.new_positions.end());
}

}  // namespace

bool may_be_cut(const Mesh& outer, const SurfaceIndex& surface, const WayOut& way, const Roof& roof,
                double tolerance) {
  const CuttingPrism prism = prism_of(way, roof, tolerance);
  return may_be_cut(outer, surface.triangles_near(axis_of(prism), reach_of(prism)), prism);
}

FailureError cannot_be_cut(const EscapeHole& hole) {
  const Vec3d end = hole.tube.end;
  return FailureError("the surface cannot be cut for an escape hole near (" + std::to_string(end.x) + ", " +
                          std::to_string(end.y) + ", " + std::to_string(end.z) + ") mm",
                      "ask for other places with --escape-hole");
}

std::variant<OuterWithHoles, UncutHoles> cut_holes(const Mesh& outer, std::span<const Sphere> balls,
                                                   const DrainagePlan& plan, const CarveOptions& options,
                                                   Monitor& monitor) {
  constexpr std::uint32_t kNew = std::numeric_limits<std::uint32_t>::max();
  UncutHoles uncut;
  OuterWithHoles result;
  result.tolerance = options.tolerance;
  Mesh& mesh = result.mesh = outer;
  std::vector<std::uint32_t> origins(mesh.triangles.size());
  std::iota(origins.begin(), origins.end(), 0U);
  for (std::size_t i = 0; i < plan.holes.size(); ++i) {
    monitor.check_interrupted();
    const EscapeHole& hole = plan.holes[i];
    const CuttingPrism prism = prism_of({hole.tube, balls[hole.from]}, plan.roof, options.tolerance);
    auto cut = cut_surface(mesh, triangles_near(mesh, axis_of(prism), reach_of(prism)), prism);
    if (!cut) {
      uncut.indices.push_back(i);
      continue;
    }
    for (const std::uint32_t t : cut->removed) {
      if (origins[t] != kNew) result.cut_triangles.push_back(origins[t]);
    }
    remove_at(origins, cut->removed);
    apply(*cut, mesh);
    origins.resize(mesh.triangles.size(), kNew);
    result.holes.push_back({std::move(cut->sides), mesh.positions.size(), prism.ring});
  }
  if (!uncut.indices.empty()) return uncut;
  std::sort(result.cut_triangles.begin(), result.cut_triangles.end());
  result.kept_triangle_count = outer.triangles.size() - result.cut_triangles.size();
  return result;
}

}  // namespace aerate
