#include "pipeline/check_output.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "kernels/point_triangle.h"
#include "pipeline/shell_topology.h"

namespace aerate {
namespace {

// Sums of fp64 terms over millions of triangles: relative to the volume that they add up to.
constexpr double kSummationError = 1e-9;

// Distances of fp32 vertices computed in fp64, relative to the radius.
constexpr double kDistanceError = 1e-9;

// Distances between fp64 balls and fp32 triangles of at most kilometres, mm.
constexpr double kLimitError = 1e-7;

template <typename... Arguments>
[[noreturn]] void fail(fmt::format_string<Arguments...> why, Arguments&&... arguments) {
  throw FailureError("the result failed its check, so it was not kept: " +
                         fmt::format(why, std::forward<Arguments>(arguments)...),
                     "please report this with the model and the options");
}

double ball_volume(double radius) {
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

// Corner by corner: the vertices may be numbered differently.
void require_same_triangles(const Mesh& read_back, const Mesh& reference, std::size_t count,
                            const char* what) {
  if (read_back.triangles.size() < count || reference.triangles.size() < count)
    fail("it has {} triangles instead of {}", read_back.triangles.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      if (!(read_back.positions[read_back.triangles[i][corner]] ==
            reference.positions[reference.triangles[i][corner]])) {
        fail("triangle {} is not the one of {}", i, what);
      }
    }
  }
}

Mesh first_triangles(const Mesh& mesh, std::size_t count) {
  Mesh part;
  part.triangles.assign(mesh.triangles.begin(), mesh.triangles.begin() + static_cast<std::ptrdiff_t>(count));
  std::uint32_t end = 0;
  for (const Triangle& t : part.triangles) end = std::max({end, t[0] + 1, t[1] + 1, t[2] + 1});
  part.positions.assign(mesh.positions.begin(), mesh.positions.begin() + end);
  return part;
}

// One void as it was written.
struct MeasuredVoid {
  Sphere ball;  // round the planned centre, holding every vertex
  double volume = 0;
  double depth = 0;  // how far the surface stays inside the planned ball at most
  Vec3d first_moment{0, 0, 0};
};

MeasuredVoid measure_void(const Mesh& mesh, std::span<const Triangle> triangles, const Sphere& planned) {
  MeasuredVoid measured;
  double farthest_squared = 0;
  double nearest_squared = std::numeric_limits<double>::infinity();
  double volume_times_6 = 0;
  Vec3d moment_times_24{0, 0, 0};
  for (const Triangle& t : triangles) {
    const kernels::Facet facet{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    const Vec3d a = to_double(facet.a) - planned.centre;
    const Vec3d b = to_double(facet.b) - planned.centre;
    const Vec3d c = to_double(facet.c) - planned.centre;
    farthest_squared = std::max({farthest_squared, length_squared(a), length_squared(b), length_squared(c)});
    nearest_squared = std::min(nearest_squared, kernels::distance_squared_to_facet(planned.centre, facet));
    // Inward triangles: the determinant is negative.
    const double determinant = -dot(a, cross(b, c));
    volume_times_6 += determinant;
    moment_times_24 = moment_times_24 + (a + b + c) * determinant;
  }
  measured.ball = {planned.centre, std::sqrt(farthest_squared), planned.kind};
  measured.volume = volume_times_6 / 6.0;
  measured.depth = planned.radius - std::sqrt(nearest_squared);
  measured.first_moment = moment_times_24 * (1.0 / 24.0) + planned.centre * measured.volume;
  return measured;
}

// Vertices of the read-back mesh are numbered in order of first use, so a shell that shares none with those
// before it uses exactly the next ones.
std::uint32_t require_own_vertices(std::span<const Triangle> triangles, std::uint32_t next,
                                   std::size_t index) {
  std::uint32_t end = next;
  for (const Triangle& t : triangles) {
    for (const std::uint32_t vertex : t) {
      if (vertex < next) fail("void {} touches another surface", index);
      end = std::max(end, vertex + 1);
    }
  }
  return end;
}

std::vector<MeasuredVoid> measure_voids(const Mesh& mesh, const ExpectedOutput& expected) {
  const auto& shells = expected.solid.void_shells;
  if (shells.size() != expected.plan.spheres.size())
    fail("{} voids were planned and {} made", expected.plan.spheres.size(), shells.size());

  std::uint32_t next_vertex = 0;
  for (std::size_t i = 0; i < expected.solid.outer_triangle_count; ++i) {
    const Triangle& t = mesh.triangles[i];
    next_vertex = std::max({next_vertex, t[0] + 1, t[1] + 1, t[2] + 1});
  }
  std::size_t next_triangle = expected.solid.outer_triangle_count;
  std::vector<MeasuredVoid> voids;
  voids.reserve(shells.size());
  for (std::size_t i = 0; i < shells.size(); ++i) {
    if (shells[i].first_triangle != next_triangle) fail("void {} is not where it belongs", i);
    next_triangle += shells[i].triangle_count;
    if (next_triangle > mesh.triangles.size()) fail("the triangles of void {} are missing", i);
    const std::span<const Triangle> triangles =
        std::span(mesh.triangles).subspan(shells[i].first_triangle, shells[i].triangle_count);
    next_vertex = require_own_vertices(triangles, next_vertex, i);
    if (const auto flaw = flaw_of_sphere_shell(triangles)) fail("the surface of void {}: {}", i, *flaw);

    const Sphere& planned = expected.plan.spheres[i];
    const MeasuredVoid measured = measure_void(mesh, triangles, planned);
    const double slack = kDistanceError * planned.radius;
    if (measured.volume <= 0) fail("void {} is not oriented inward", i);
    if (measured.ball.radius > planned.radius + slack)
      fail("void {} has radius {:.9g} mm, planned were {:.9g} mm", i, measured.ball.radius, planned.radius);
    if (measured.depth > expected.tolerance + slack)
      fail("void {} stays {:.4g} mm inside its ball, the tolerance is {:.4g} mm", i, measured.depth,
           expected.tolerance);
    const double least = ball_volume(std::max(0.0, planned.radius - expected.tolerance));
    const double most = ball_volume(planned.radius);
    if (measured.volume < least * (1 - kSummationError) || measured.volume > most * (1 + kSummationError))
      fail("void {} has {:.6g} mm3, planned were {:.6g} mm3", i, measured.volume, most);
    voids.push_back(measured);
  }
  if (next_triangle != mesh.triangles.size())
    fail("it has {} triangles too many", mesh.triangles.size() - next_triangle);
  return voids;
}

void require_sound_outer(const Mesh& outer, const ExpectedOutput& expected) {
  if (expected.surface == OuterSurface::kept) {
    // The same triangles with the same coordinates have the same edges: what inspection found out about the
    // model holds for the outer part.
    require_same_triangles(outer, expected.model, expected.model.triangles.size(), "the model");
    if (!expected.inspection.closed()) fail("the outer surface is not closed");
    return;
  }
  const Inspection inspection = inspect(outer);
  if (inspection.open_edges > 0) fail("the outer surface has {} open edges", inspection.open_edges);
  if (inspection.misoriented_edges > 0)
    fail("the outer surface has {} misoriented edges", inspection.misoriented_edges);
  if (inspection.non_manifold_edges > expected.inspection.non_manifold_edges)
    fail("the outer surface has {} non-manifold edges, the model has {}", inspection.non_manifold_edges,
         expected.inspection.non_manifold_edges);
  if (inspection.volume <= 0) fail("the outer surface is inside out");
}

// The wall and the gap hold round the measured balls, and these lie where the model is solid once. The latter
// needs no new look if the surface was kept: neither the triangles nor the centres have changed since the
// packing was verified.
Clearances measure_limits(const Mesh& outer, const std::vector<Sphere>& balls,
                          const ExpectedOutput& expected) {
  const PackingLimits& limits = expected.limits;
  if (expected.surface == OuterSurface::remeshed) {
    const PackingLimits written{
        .wall = 0, .gap = 0, .min_radius = 0, .max_radius = limits.max_radius + limits.gap};
    Packing measured;
    measured.spheres = balls;
    measured.limits = written;
    const Packing verified = verify_packing(outer, std::move(measured));
    if (verified.spheres.size() != balls.size() || verified.statistics.shrunk_by_verification > 0)
      fail("{} voids lie where the model is not solid once",
           verified.statistics.dropped_by_verification + verified.statistics.shrunk_by_verification);
  }
  const Clearances clearances = measure_clearances(outer, balls);
  if (clearances.wall < limits.wall - kLimitError)
    fail("the wall is {:.9g} mm, the limit {:.9g} mm", clearances.wall, limits.wall);
  if (clearances.gap && *clearances.gap < limits.gap - kLimitError)
    fail("the gap is {:.9g} mm, the limit {:.9g} mm", *clearances.gap, limits.gap);
  return clearances;
}

std::optional<Vec3d> centre_of_mass(double volume, Vec3d first_moment, const Inspection& inspection) {
  if (inspection.parts_overlap()) return std::nullopt;
  return first_moment * (1.0 / volume);
}

}  // namespace

OutputFacts check_output(const Mesh& read_back, const ExpectedOutput& expected) {
  const Solid& solid = expected.solid;
  require_same_triangles(read_back, solid.mesh, solid.mesh.triangles.size(), "the result");
  const Mesh outer = first_triangles(read_back, solid.outer_triangle_count);
  require_sound_outer(outer, expected);
  const std::vector<MeasuredVoid> voids = measure_voids(read_back, expected);

  std::vector<Sphere> balls;
  balls.reserve(voids.size());
  for (const MeasuredVoid& measured : voids) balls.push_back(measured.ball);

  OutputFacts facts;
  facts.triangle_count = read_back.triangles.size();
  facts.outer_triangle_count = outer.triangles.size();
  facts.void_triangle_count = facts.triangle_count - facts.outer_triangle_count;
  facts.void_count = voids.size();
  facts.smallest_radius = std::numeric_limits<double>::infinity();
  Vec3d removed_moment{0, 0, 0};
  for (const MeasuredVoid& measured : voids) {
    facts.volume_removed += measured.volume;
    removed_moment = removed_moment + measured.first_moment;
    facts.smallest_radius = std::min(facts.smallest_radius, measured.ball.radius);
    facts.largest_radius = std::max(facts.largest_radius, measured.ball.radius);
    facts.void_deviation = std::max(facts.void_deviation, measured.depth);
  }
  facts.clearances = measure_limits(outer, balls, expected);

  const VolumeMoments outer_moments = volume_moments(outer);
  const VolumeMoments whole_moments = volume_moments(read_back);
  const double difference = outer_moments.volume - facts.volume_removed - whole_moments.volume;
  if (std::abs(difference) > kSummationError * outer_moments.volume)
    fail("the model less its voids has {:.9g} mm3, the result {:.9g} mm3",
         outer_moments.volume - facts.volume_removed, whole_moments.volume);

  // With overlapping parts the signed volume counts the overlap twice; a slicer fills it once.
  const bool overlapping = expected.inspection.parts_overlap();
  facts.volume_before = overlapping ? expected.inspection.filled_volume : outer_moments.volume;
  facts.volume_after = overlapping ? facts.volume_before - facts.volume_removed : whole_moments.volume;
  facts.centre_of_mass_before =
      centre_of_mass(outer_moments.volume, outer_moments.first_moment, expected.inspection);
  facts.centre_of_mass_after =
      centre_of_mass(outer_moments.volume - facts.volume_removed, outer_moments.first_moment - removed_moment,
                     expected.inspection);
  return facts;
}

}  // namespace aerate
