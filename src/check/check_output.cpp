#include "check/check_output.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "check/check_failure.h"
#include "check/check_voids.h"
#include "check/polled_loop.h"
#include "check/same_triangles.h"

namespace aerate {
namespace {

// Sums of fp64 terms over millions of triangles: relative to the volume that they add up to.
constexpr double kSummationError = 1e-9;

// Distances between fp64 balls and fp32 triangles of at most kilometres, mm.
constexpr double kLimitError = 1e-7;

// Triangles that are added up between two questions to the monitor.
constexpr std::size_t kTrianglesPerPiece = std::size_t{1} << 22;

// Triangles whose terms are added up in one go; the sums of blocks are then added in their order, so that a
// volume does not depend on threads.
constexpr std::size_t kTrianglesPerSum = std::size_t{1} << 14;

Mesh first_triangles(const Mesh& mesh, std::size_t count) {
  Mesh part;
  part.triangles.assign(mesh.triangles.begin(), mesh.triangles.begin() + static_cast<std::ptrdiff_t>(count));
  std::uint32_t end = 0;
  for (const Triangle& t : part.triangles) end = std::max({end, t[0] + 1, t[1] + 1, t[2] + 1});
  part.positions.assign(mesh.positions.begin(), mesh.positions.begin() + end);
  return part;
}

double volume_of(const Mesh& mesh, Monitor& monitor) {
  const Box3f box = bounding_box(mesh);
  const Vec3d origin = (to_double(box.lower) + to_double(box.upper)) * 0.5;
  const std::size_t count = mesh.triangles.size();
  std::vector<double> volumes((count + kTrianglesPerSum - 1) / kTrianglesPerSum);
  for_each_polled(volumes.size(), kTrianglesPerPiece / kTrianglesPerSum, monitor, [&](std::size_t block) {
    const std::size_t first = block * kTrianglesPerSum;
    const auto triangles =
        std::span(mesh.triangles).subspan(first, std::min(kTrianglesPerSum, count - first));
    volumes[block] = volume_moments(mesh, triangles, origin).volume;
  });
  double volume = 0;
  for (const double block : volumes) volume += block;
  return volume;
}

// The same triangles with the same coordinates have the same edges: what inspection found out about the model
// holds for the outer part, and the model may stand for it.
void require_kept_outer(const Mesh& read_back, const ExpectedOutput& expected, Monitor& monitor) {
  const std::size_t count = expected.model.triangles.size();
  if (expected.solid.outer_triangle_count != count)
    fail_check("{} of its triangles are outside, the model has {}", expected.solid.outer_triangle_count,
               count);
  require_same_triangles(read_back, expected.model, "the model", monitor);
  if (!expected.inspection.closed()) fail_check("the outer surface is not closed");
}

void require_sound_outer(const Mesh& outer, const Inspection& model) {
  const Inspection inspection = inspect(outer);
  if (inspection.open_edges > 0) fail_check("the outer surface has {} open edges", inspection.open_edges);
  if (inspection.misoriented_edges > 0)
    fail_check("the outer surface has {} misoriented edges", inspection.misoriented_edges);
  if (inspection.non_manifold_edges > model.non_manifold_edges)
    fail_check("the outer surface has {} non-manifold edges, the model has {}", inspection.non_manifold_edges,
               model.non_manifold_edges);
  if (inspection.volume <= 0) fail_check("the outer surface is inside out");
}

// The wall and the gap hold round the measured balls, and these lie where the model is solid once. The latter
// needs no new look if the surface was kept: neither the triangles nor the centres have changed since the
// packing was verified.
Clearances measure_limits(const SurfaceIndex& outer, const std::vector<Sphere>& balls,
                          const ExpectedOutput& expected) {
  const PackingLimits& limits = expected.limits;
  if (expected.outer == OuterSurface::remeshed) {
    const PackingLimits written{.wall = 0,
                                .gap = 0,
                                .min_radius = 0,
                                .max_radius = limits.max_radius + limits.gap,
                                .roof = limits.roof};
    Packing measured;
    measured.spheres = balls;
    measured.limits = written;
    const Packing verified = verify_packing(outer, std::move(measured));
    if (verified.spheres.size() != balls.size() || verified.statistics.shrunk_by_verification > 0)
      fail_check("{} voids lie where the model is not solid once",
                 verified.statistics.dropped_by_verification + verified.statistics.shrunk_by_verification);
  }
  const Clearances clearances = measure_clearances(outer, balls, limits.roof);
  if (clearances.wall < limits.wall - kLimitError)
    fail_check("the wall is {:.9g} mm, the limit {:.9g} mm", clearances.wall, limits.wall);
  if (clearances.gap && *clearances.gap < limits.gap - kLimitError)
    fail_check("the gap is {:.9g} mm, the limit {:.9g} mm", *clearances.gap, limits.gap);
  return clearances;
}

std::optional<Ceilings> measure_limited_ceilings(const Mesh& read_back, const ExpectedOutput& expected,
                                                 Monitor& monitor) {
  const Roof& roof = expected.limits.roof;
  if (!roof.limits_ceilings()) return std::nullopt;
  const Ceilings ceilings = measure_ceilings(read_back, expected.solid.void_shells, roof, monitor);
  require_bridged(ceilings, roof, expected.tolerance);
  return ceilings;
}

std::optional<Vec3d> centre_of_mass(double volume, Vec3d first_moment, const Inspection& inspection) {
  if (inspection.parts_overlap()) return std::nullopt;
  return first_moment * (1.0 / volume);
}

// Sums and extremes over the voids.
struct VoidTotals {
  double volume = 0;
  Vec3d first_moment{0, 0, 0};
  double smallest_radius = std::numeric_limits<double>::infinity();
  double largest_radius = 0;
  double depth = 0;
  std::vector<Sphere> balls;
};

VoidTotals add_up(const std::vector<MeasuredVoid>& voids) {
  VoidTotals totals;
  totals.balls.reserve(voids.size());
  for (const MeasuredVoid& measured : voids) {
    totals.volume += measured.volume;
    totals.first_moment = totals.first_moment + measured.first_moment;
    totals.smallest_radius = std::min(totals.smallest_radius, measured.ball.radius);
    totals.largest_radius = std::max(totals.largest_radius, measured.ball.radius);
    totals.depth = std::max(totals.depth, measured.depth);
    totals.balls.push_back(measured.ball);
  }
  return totals;
}

}  // namespace

OutputFacts check_output(const Mesh& read_back, const ExpectedOutput& expected, Monitor& monitor) {
  const Solid& solid = expected.solid;
  require_same_triangles(read_back, solid.mesh, "the result", monitor);
  std::optional<Mesh> remeshed;
  if (expected.outer == OuterSurface::kept) {
    require_kept_outer(read_back, expected, monitor);
  } else {
    remeshed = first_triangles(read_back, solid.outer_triangle_count);
    require_sound_outer(*remeshed, expected.inspection);
  }
  const Mesh& outer = remeshed ? *remeshed : expected.model;
  std::optional<SurfaceIndex> remeshed_surface;
  if (remeshed) remeshed_surface.emplace(*remeshed);
  const VoidTotals voids = add_up(check_voids(read_back, solid, expected.plan, expected.tolerance, monitor));
  monitor.check_interrupted();

  OutputFacts facts;
  facts.triangle_count = read_back.triangles.size();
  facts.outer_triangle_count = solid.outer_triangle_count;
  facts.void_triangle_count = facts.triangle_count - facts.outer_triangle_count;
  facts.void_count = voids.balls.size();
  facts.volume_removed = voids.volume;
  facts.smallest_radius = voids.smallest_radius;
  facts.largest_radius = voids.largest_radius;
  facts.void_deviation = voids.depth;
  facts.roof_count = static_cast<std::size_t>(
      std::count_if(expected.plan.spheres.begin(), expected.plan.spheres.end(),
                    [&](const Sphere& planned) { return expected.plan.roof.shapes(planned.radius); }));
  facts.ceilings = measure_limited_ceilings(read_back, expected, monitor);
  facts.clearances =
      measure_limits(remeshed_surface ? *remeshed_surface : expected.surface, voids.balls, expected);
  monitor.check_interrupted();

  const VolumeMoments outer_moments = volume_moments(outer);
  const double whole_volume = volume_of(read_back, monitor);
  const double difference = outer_moments.volume - voids.volume - whole_volume;
  if (std::abs(difference) > kSummationError * outer_moments.volume)
    fail_check("the model less its voids has {:.9g} mm3, the result {:.9g} mm3",
               outer_moments.volume - voids.volume, whole_volume);

  // With overlapping parts the signed volume counts the overlap twice; a slicer fills it once.
  const bool overlapping = expected.inspection.parts_overlap();
  facts.volume_before = overlapping ? expected.inspection.filled_volume : outer_moments.volume;
  facts.volume_after = overlapping ? facts.volume_before - voids.volume : whole_volume;
  facts.centre_of_mass_before =
      centre_of_mass(outer_moments.volume, outer_moments.first_moment, expected.inspection);
  facts.centre_of_mass_after =
      centre_of_mass(outer_moments.volume - voids.volume, outer_moments.first_moment - voids.first_moment,
                     expected.inspection);
  return facts;
}

}  // namespace aerate
