#include "check/check_written.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "check/check_cells.h"
#include "check/check_drained.h"
#include "check/check_failure.h"
#include "check/check_kept.h"
#include "check/check_sealed.h"
#include "check/check_tubes.h"
#include "check/check_voids.h"
#include "check/measure_errors.h"
#include "check/outer_surface.h"
#include "check/polled_loop.h"
#include "check/same_triangles.h"
#include "check/tube_cut.h"
#include "core/void_shape.h"

namespace aerate {
namespace {

// Triangles that are added up between two questions to the monitor.
constexpr std::size_t kTrianglesPerPiece = std::size_t{1} << 22;

// Triangles whose terms are added up in one go; the sums of blocks are then added in their order, so that a
// volume does not depend on threads.
constexpr std::size_t kTrianglesPerSum = std::size_t{1} << 14;

void require_planned_parts(const Mesh& read_back, const Expected& expected) {
  const auto made = [&](PartKind kind) { return expected.solid.of(kind).size(); };
  const std::size_t voids =
      expected.cells != nullptr ? expected.cells->voids.size() : expected.packing.spheres.size();
  const std::size_t channels = expected.drainage != nullptr ? expected.drainage->channels.size() : 0;
  const std::size_t holes = expected.drainage != nullptr ? expected.drainage->holes.size() : 0;
  if (made(PartKind::void_surface) != voids || made(PartKind::channel) != channels ||
      made(PartKind::hole) != holes || made(PartKind::outer) != 1)
    fail_check("{} voids, {} channels and {} holes were planned; {}, {} and {} made", voids, channels, holes,
               made(PartKind::void_surface), made(PartKind::channel), made(PartKind::hole));
  if (expected.drainage == nullptr && made(PartKind::remnant) > 0)
    fail_check("the surface was cut although no hole was planned");
  std::size_t next = 0;
  PartKind last = PartKind::outer;
  for (const SolidPart& part : expected.solid.parts) {
    if (part.first_triangle != next || part.kind < last)
      fail_check("triangle {} is of no part, or of two", next);
    next = part.end();
    last = part.kind;
  }
  if (next != read_back.triangles.size()) fail_check("triangle {} is of no part", next);
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

// The voids lie where the winding number is 1, as was verified for their planned spheres.
Clearances measure_limits(const std::vector<Sphere>& balls, const Expected& expected) {
  const PackingLimits& limits = expected.packing.limits;
  const Clearances clearances = measure_clearances(expected.surface, balls, limits.roof);
  if (clearances.wall < limits.wall - kLimitError)
    fail_check("the wall is {:.9g} mm, the limit {:.9g} mm", clearances.wall, limits.wall);
  if (clearances.gap && *clearances.gap < limits.gap - kLimitError)
    fail_check("the gap is {:.9g} mm, the limit {:.9g} mm", *clearances.gap, limits.gap);
  return clearances;
}

// Of voids, and of channels and holes, which are one surface with theirs.
std::optional<Ceilings> measure_limited_ceilings(const Mesh& read_back, const Expected& expected,
                                                 Monitor& monitor) {
  const std::size_t first = expected.solid.outer_triangle_count();
  const SolidPart all{PartKind::void_surface, first, read_back.triangles.size() - first};
  const auto parts =
      expected.drainage != nullptr ? std::span(&all, 1) : expected.solid.of(PartKind::void_surface);
  return limited_ceilings(read_back, parts, expected.packing.limits.roof, expected.tolerance, monitor);
}

// What is left of a model, and what was taken out of it.
struct Remainder {
  double removed = 0;  // mm3
  double volume = 0;   // mm3
  Vec3d centre;        // of its mass
};

// Sealed voids have volumes of their own.
Remainder without_sealed(const Mesh& read_back, const VolumeMoments& whole, const VolumeMoments& in_voids,
                         Monitor& monitor) {
  const VolumeMoments rest{whole.volume - in_voids.volume, whole.first_moment - in_voids.first_moment};
  const double written = volume_of(read_back, monitor);
  if (std::abs(rest.volume - written) > kSummationError * whole.volume)
    fail_check("the model less its voids has {:.9g} mm3, the result {:.9g} mm3", rest.volume, written);
  return {in_voids.volume, written, rest.first_moment * (1 / rest.volume)};
}

// Of cells, more (1) or less (-1) by what their surfaces may be off.
double volume_of_cells(const Expected& expected, double sign) {
  double volume = 0;
  for (const CellVoid& piece : expected.cells->voids)
    volume += piece.planned_volume +
              sign * std::max(piece.deviation, expected.tolerance) * surface_area(piece.surface);
  return volume;
}

// Voids and channels outside them, and holes to where their cut ends.
double most_removed(const Expected& expected) {
  double volume = expected.cells != nullptr ? volume_of_cells(expected, 1) : total_volume(expected.packing);
  const auto add = [&](const Tube& tube, double beyond) {
    volume +=
        std::numbers::pi * tube.radius * tube.radius * (length(tube.end - tube.start) + beyond * tube.radius);
  };
  for (const Channel& channel : expected.drainage->channels) add(channel.tube, 0);
  for (const EscapeHole& hole : expected.drainage->holes) add(hole.tube, kCutBeyond);
  return volume;
}

double least_removed(const Expected& expected) {
  if (expected.cells != nullptr) return volume_of_cells(expected, -1);
  double volume = 0;
  for (const Sphere& ball : expected.packing.spheres)
    volume += VoidShape(ball, expected.packing.limits.roof).volume_within(expected.tolerance);
  return volume;
}

Remainder without_drained(const Mesh& read_back, const VolumeMoments& whole, const Expected& expected) {
  const VolumeMoments rest = volume_moments(read_back);
  const double removed = whole.volume - rest.volume;
  const double error = kSummationError * whole.volume;
  if (removed < least_removed(expected) - error || removed > most_removed(expected) + error)
    fail_check("{:.9g} mm3 are removed, planned were {:.9g} to {:.9g}", removed, least_removed(expected),
               most_removed(expected));
  return {removed, whole.volume - removed, rest.first_moment * (1 / rest.volume)};
}

void add_volumes(OutputFacts& facts, const VolumeMoments& whole, const Remainder& left,
                 const Inspection& model) {
  facts.volume_removed = left.removed;
  // With overlapping parts the signed volume counts the overlap twice; a slicer fills it once.
  if (model.parts_overlap()) {
    facts.volume_before = model.filled_volume;
    facts.volume_after = facts.volume_before - left.removed;
    return;
  }
  facts.volume_before = whole.volume;
  facts.volume_after = left.volume;
  facts.centre_of_mass_before = whole.first_moment * (1 / whole.volume);
  facts.centre_of_mass_after = left.centre;
}

std::size_t count_cavities(const Inspection& model) {
  return static_cast<std::size_t>(std::count_if(model.shells.begin(), model.shells.end(),
                                                [](const Shell& shell) { return shell.volume < 0; }));
}

// What is found on voids of either shape.
struct MeasuredVoids {
  std::optional<VolumeMoments> sealed;  // of those that are sealed
  Clearances clearances;
  double deviation = 0;
  double smallest_radius = kInfinity, largest_radius = 0;
  std::size_t roof_count = 0;
};

MeasuredVoids measure_balls(const Mesh& read_back, const Expected& expected, Monitor& monitor) {
  const bool drains = expected.drainage != nullptr;
  if (!drains) check_sealed(read_back, expected, monitor);
  MeasuredVoids result;
  std::vector<Sphere> balls;
  VolumeMoments inside;
  for (const MeasuredVoid& measured : check_voids(read_back, expected, monitor)) {
    balls.push_back(measured.ball);
    result.smallest_radius = std::min(result.smallest_radius, measured.ball.radius);
    result.largest_radius = std::max(result.largest_radius, measured.ball.radius);
    result.deviation = std::max(result.deviation, measured.depth);
    inside.volume += measured.volume;
    inside.first_moment = inside.first_moment + measured.first_moment;
  }
  if (!drains) result.sealed = inside;
  const std::vector<Sphere>& planned = expected.packing.spheres;
  result.roof_count =
      static_cast<std::size_t>(std::count_if(planned.begin(), planned.end(), [&](const Sphere& sphere) {
        return expected.packing.limits.roof.shapes(sphere.radius);
      }));
  result.clearances = measure_limits(balls, expected);
  return result;
}

MeasuredVoids measure_cells(const Mesh& read_back, const Expected& expected, Monitor& monitor) {
  // With holes it is looked at as one surface with the voids.
  if (expected.outer == OuterSurface::remeshed && expected.drainage == nullptr)
    require_sound_outer(read_back, expected);
  const MeasuredCells measured = check_cells(read_back, expected, monitor);
  MeasuredVoids result;
  if (expected.drainage == nullptr) result.sealed = measured.inside;
  result.clearances = measured.clearances;
  result.deviation = measured.deviation;
  for (const CellVoid& piece : expected.cells->voids) {
    const double radius = expected.packing.spheres[piece.cell].radius;
    result.smallest_radius = std::min(result.smallest_radius, radius);
    result.largest_radius = std::max(result.largest_radius, radius);
    result.roof_count += piece.has_roof ? 1 : 0;
  }
  return result;
}

}  // namespace

OutputFacts check_written(const Mesh& read_back, const Expected& expected, Monitor& monitor) {
  require_same_triangles(read_back, expected.solid.mesh, monitor);
  require_planned_parts(read_back, expected);
  const std::size_t cut_triangles = check_outer_surface(read_back, expected, monitor);
  monitor.check_interrupted();

  OutputFacts facts;
  const bool drains = expected.drainage != nullptr;
  const MeasuredVoids voids = expected.cells != nullptr ? measure_cells(read_back, expected, monitor)
                                                        : measure_balls(read_back, expected, monitor);
  if (drains) {
    facts.drainage = {.cavities_of_model = count_cavities(expected.inspection),
                      .cut_triangles = cut_triangles,
                      .channel_wall = check_tubes(read_back, expected)};
    facts.drainage->sealed_cavities = check_drained(read_back, expected, monitor);
  }
  if (expected.kept != nullptr) facts.kept_wall = check_kept(read_back, expected, monitor);
  monitor.check_interrupted();

  facts.triangle_count = read_back.triangles.size();
  facts.outer_triangle_count = expected.solid.outer_triangle_count();
  facts.void_triangle_count = facts.triangle_count - facts.outer_triangle_count;
  facts.void_count = expected.solid.of(PartKind::void_surface).size();
  facts.smallest_radius = voids.smallest_radius;
  facts.largest_radius = voids.largest_radius;
  facts.void_deviation = voids.deviation;
  facts.roof_count = voids.roof_count;
  facts.ceilings = measure_limited_ceilings(read_back, expected, monitor);
  facts.clearances = voids.clearances;
  monitor.check_interrupted();

  const VolumeMoments whole = volume_moments(expected.model);
  add_volumes(facts, whole,
              voids.sealed ? without_sealed(read_back, whole, *voids.sealed, monitor)
                           : without_drained(read_back, whole, expected),
              expected.inspection);
  return facts;
}

}  // namespace aerate
