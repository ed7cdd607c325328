#include "check/check_voids.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "check/check_failure.h"
#include "check/planned_shape.h"
#include "check/polled_loop.h"
#include "check/shell_topology.h"

namespace aerate {
namespace {

// Distances of fp32 vertices computed in fp64, relative to the radius.
constexpr double kDistanceError = 1e-9;

// Sums of fp64 terms over the triangles of a void: relative to the volume that they add up to.
constexpr double kSummationError = 1e-9;

// Voids between two questions to the monitor: about ten million triangles at the very most.
constexpr std::size_t kVoidsPerPiece = 4096;

// Throws unless the shells follow the outer surface and each other up to the last triangle.
void require_shells_in_order(const Mesh& mesh, const Solid& solid) {
  std::size_t next = solid.outer_triangle_count;
  for (std::size_t i = 0; i < solid.void_shells.size(); ++i) {
    if (solid.void_shells[i].first_triangle != next) fail_check("void {} is not where it belongs", i);
    next += solid.void_shells[i].triangle_count;
    if (next > mesh.triangles.size()) fail_check("the triangles of void {} are missing", i);
  }
  if (next != mesh.triangles.size()) fail_check("it has {} triangles too many", mesh.triangles.size() - next);
}

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

MeasuredVoid measure_void(const Mesh& mesh, std::span<const Triangle> triangles, const Sphere& planned,
                          PlannedShape& shape) {
  MeasuredVoid measured;
  double depth = 0;
  double volume_times_6 = 0;
  Vec3d moment_times_24{0, 0, 0};
  for (const Triangle& t : triangles) {
    const kernels::Facet facet{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    const Vec3d a = to_double(facet.a) - planned.centre;
    const Vec3d b = to_double(facet.b) - planned.centre;
    const Vec3d c = to_double(facet.c) - planned.centre;
    for (const Vec3f& p : {facet.a, facet.b, facet.c}) shape.hold(p);
    depth = std::max(depth, shape.depth(facet));
    // Inward triangles: the determinant is negative.
    const double determinant = -dot(a, cross(b, c));
    volume_times_6 += determinant;
    moment_times_24 = moment_times_24 + (a + b + c) * determinant;
  }
  measured.ball = {planned.centre, shape.radius(), planned.kind};
  measured.volume = volume_times_6 / 6.0;
  measured.depth = depth;
  measured.first_moment = moment_times_24 * (1.0 / 24.0) + planned.centre * measured.volume;
  return measured;
}

std::optional<std::string> flaw_of_measures(const MeasuredVoid& measured, const Sphere& planned,
                                            const PlannedShape& shape, double tolerance) {
  const double slack = kDistanceError * planned.radius;
  if (measured.volume <= 0) return "it is not oriented inward";
  if (measured.ball.radius > planned.radius + slack)
    return fmt::format("it has radius {:.9g} mm, planned were {:.9g} mm", measured.ball.radius,
                       planned.radius);
  if (measured.depth > tolerance + slack)
    return fmt::format("it stays {:.4g} mm inside its planned shape, the tolerance is {:.4g} mm",
                       measured.depth, tolerance);
  const double least = shape.volume_within(tolerance);
  const double most = shape.volume();
  if (measured.volume < least * (1 - kSummationError) || measured.volume > most * (1 + kSummationError))
    return fmt::format("it has {:.6g} mm3, planned were {:.6g} mm3", measured.volume, most);
  return std::nullopt;
}

// What one void was found to be, for the messages to be given in order.
struct Finding {
  VertexRange vertices;
  std::optional<std::string> flaw;
};

}  // namespace

std::vector<MeasuredVoid> check_voids(const Mesh& mesh, const Solid& solid, const VoidPlan& plan,
                                      double tolerance, Monitor& monitor) {
  const std::vector<ShellRange>& shells = solid.void_shells;
  if (shells.size() != plan.spheres.size())
    fail_check("{} voids were planned and {} made", plan.spheres.size(), shells.size());
  require_shells_in_order(mesh, solid);

  std::vector<MeasuredVoid> voids(shells.size());
  std::vector<Finding> findings(shells.size());
  for_each_polled(shells.size(), kVoidsPerPiece, monitor, [&](std::size_t i) {
    const std::span<const Triangle> triangles =
        std::span(mesh.triangles).subspan(shells[i].first_triangle, shells[i].triangle_count);
    Finding& finding = findings[i];
    finding.vertices = vertices_of(triangles);
    if (!finding.vertices.can_be_own(triangles.size())) return;
    finding.flaw = flaw_of_sphere_shell(triangles);
    if (finding.flaw) return;
    PlannedShape shape(plan.roof, plan.spheres[i]);
    voids[i] = measure_void(mesh, triangles, plan.spheres[i], shape);
    finding.flaw = flaw_of_measures(voids[i], plan.spheres[i], shape, tolerance);
  });

  // A shell that shares no vertex with what came before uses exactly the next numbers.
  std::uint32_t next_vertex = vertices_of(std::span(mesh.triangles).first(solid.outer_triangle_count)).end;
  for (std::size_t i = 0; i < findings.size(); ++i) {
    if (findings[i].vertices.lowest < next_vertex) fail_check("void {} touches another surface", i);
    if (findings[i].flaw) fail_check("void {}: {}", i, *findings[i].flaw);
    next_vertex = std::max(next_vertex, findings[i].vertices.end);
  }
  return voids;
}

}  // namespace aerate
