#include "check/check_written.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "check/check_drained.h"
#include "check/check_failure.h"
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
  const std::size_t voids = expected.packing.spheres.size();
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
  const Roof& roof = expected.packing.limits.roof;
  if (!roof.limits_ceilings()) return std::nullopt;
  const std::size_t first = expected.solid.outer_triangle_count();
  const SolidPart all{PartKind::void_surface, first, read_back.triangles.size() - first};
  const Ceilings ceilings = measure_ceilings(
      read_back,
      expected.drainage != nullptr ? std::span(&all, 1) : expected.solid.of(PartKind::void_surface), roof,
      monitor);
  require_bridged(ceilings, roof, expected.tolerance);
  return ceilings;
}

// What is left of a model, and what was taken out of it.
struct Remainder {
  double removed = 0;  // mm3
  double volume = 0;   // mm3
  Vec3d centre;        // of its mass
};

// Sealed voids have volumes of their own.
Remainder without_sealed(const Mesh& read_back, const VolumeMoments& whole,
                         const std::vector<MeasuredVoid>& voids, Monitor& monitor) {
  VolumeMoments in_voids;
  for (const MeasuredVoid& measured : voids) {
    in_voids.volume += measured.volume;
    in_voids.first_moment = in_voids.first_moment + measured.first_moment;
  }
  const VolumeMoments rest{whole.volume - in_voids.volume, whole.first_moment - in_voids.first_moment};
  const double written = volume_of(read_back, monitor);
  if (std::abs(rest.volume - written) > kSummationError * whole.volume)
    fail_check("the model less its voids has {:.9g} mm3, the result {:.9g} mm3", rest.volume, written);
  return {in_voids.volume, written, rest.first_moment * (1 / rest.volume)};
}

// Balls and channels outside them, and holes to where their cut ends.
double most_removed(const Expected& expected) {
  double volume = total_volume(expected.packing);
  const auto add = [&](const Tube& tube, double beyond) {
    volume +=
        std::numbers::pi * tube.radius * tube.radius * (length(tube.end - tube.start) + beyond * tube.radius);
  };
  for (const Channel& channel : expected.drainage->channels) add(channel.tube, 0);
  for (const EscapeHole& hole : expected.drainage->holes) add(hole.tube, kCutBeyond);
  return volume;
}

double least_removed(const Expected& expected) {
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

}  // namespace

OutputFacts check_written(const Mesh& read_back, const Expected& expected, Monitor& monitor) {
  require_same_triangles(read_back, expected.solid.mesh, monitor);
  require_planned_parts(read_back, expected);
  const std::size_t cut_triangles = check_outer_surface(read_back, expected, monitor);
  monitor.check_interrupted();

  OutputFacts facts;
  const bool drains = expected.drainage != nullptr;
  if (!drains) check_sealed(read_back, expected, monitor);
  const std::vector<MeasuredVoid> voids = check_voids(read_back, expected, monitor);
  if (drains) {
    facts.drainage = {.cavities_of_model = count_cavities(expected.inspection),
                      .cut_triangles = cut_triangles,
                      .channel_wall = check_tubes(read_back, expected)};
    facts.drainage->sealed_cavities = check_drained(read_back, expected, monitor);
  }
  monitor.check_interrupted();

  facts.triangle_count = read_back.triangles.size();
  facts.outer_triangle_count = expected.solid.outer_triangle_count();
  facts.void_triangle_count = facts.triangle_count - facts.outer_triangle_count;
  facts.void_count = voids.size();
  facts.smallest_radius = std::numeric_limits<double>::infinity();
  std::vector<Sphere> balls;
  for (const MeasuredVoid& measured : voids) {
    balls.push_back(measured.ball);
    facts.smallest_radius = std::min(facts.smallest_radius, measured.ball.radius);
    facts.largest_radius = std::max(facts.largest_radius, measured.ball.radius);
    facts.void_deviation = std::max(facts.void_deviation, measured.depth);
  }
  const std::vector<Sphere>& planned = expected.packing.spheres;
  facts.roof_count =
      static_cast<std::size_t>(std::count_if(planned.begin(), planned.end(), [&](const Sphere& sphere) {
        return expected.packing.limits.roof.shapes(sphere.radius);
      }));
  facts.ceilings = measure_limited_ceilings(read_back, expected, monitor);
  facts.clearances = measure_limits(balls, expected);
  monitor.check_interrupted();

  const VolumeMoments whole = volume_moments(expected.model);
  add_volumes(
      facts, whole,
      drains ? without_drained(read_back, whole, expected) : without_sealed(read_back, whole, voids, monitor),
      expected.inspection);
  return facts;
}

}  // namespace aerate
