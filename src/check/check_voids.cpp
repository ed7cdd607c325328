#include "check/check_voids.h"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <optional>
#include <span>
#include <string>

#include "check/check_failure.h"
#include "check/measure_errors.h"
#include "check/polled_loop.h"
#include "core/void_shape.h"

namespace aerate {
namespace {

MeasuredVoid measure_void(const Mesh& mesh, const SolidPart& part, const Sphere& planned,
                          const VoidShape& shape) {
  MeasuredVoid measured;
  double radius = 0;
  double volume_times_6 = 0;
  Vec3d moment_times_24{0, 0, 0};
  for (const Triangle& t : triangles_of(mesh, part)) {
    const kernels::Facet facet = facet_of(mesh, t);
    for (const Vec3f& p : {facet.a, facet.b, facet.c})
      radius = std::max(radius, shape.least_radius_holding(to_double(p)));
    measured.depth = std::max(measured.depth, shape.depth(facet));
    const Vec3d a = to_double(facet.a) - planned.centre;
    const Vec3d b = to_double(facet.b) - planned.centre;
    const Vec3d c = to_double(facet.c) - planned.centre;
    // Seen from the centre a triangle that faces it runs clockwise.
    const double determinant = -dot(a, cross(b, c));
    measured.faces_centre = measured.faces_centre && determinant > 0;
    volume_times_6 += determinant;
    moment_times_24 = moment_times_24 + (a + b + c) * determinant;
  }
  measured.ball = {planned.centre, radius, planned.kind};
  measured.volume = volume_times_6 / 6.0;
  measured.first_moment = moment_times_24 * (1.0 / 24.0) + planned.centre * measured.volume;
  return measured;
}

std::optional<std::string> flaw_of_place(const MeasuredVoid& measured, const Sphere& planned,
                                         double tolerance) {
  const double slack = kDistanceError * planned.radius;
  if (measured.ball.radius > planned.radius + slack)
    return fmt::format("it has radius {:.9g} mm, planned were {:.9g} mm", measured.ball.radius,
                       planned.radius);
  if (measured.depth > tolerance + slack)
    return fmt::format("it stays {:.4g} mm inside its planned shape, the tolerance is {:.4g} mm",
                       measured.depth, tolerance);
  return std::nullopt;
}

std::optional<std::string> flaw_of_volume(const MeasuredVoid& measured, const VoidShape& shape,
                                          double tolerance) {
  const double least = shape.volume_within(tolerance), most = shape.volume();
  if (measured.volume >= least * (1 - kSummationError) && measured.volume <= most * (1 + kSummationError))
    return std::nullopt;
  return fmt::format("it has {:.6g} mm3, planned were {:.6g} mm3", measured.volume, most);
}

}  // namespace

std::vector<MeasuredVoid> check_voids(const Mesh& read_back, const Expected& expected, Monitor& monitor) {
  const std::span<const SolidPart> parts = expected.solid.of(PartKind::void_surface);
  const bool drains = expected.drainage != nullptr;
  std::vector<MeasuredVoid> voids(parts.size());
  std::vector<std::optional<std::string>> flaws(parts.size());
  for_each_polled(parts.size(), kVoidsPerPiece, monitor, [&](std::size_t i) {
    const Sphere& planned = expected.packing.spheres[i];
    const VoidShape shape(planned, expected.packing.limits.roof);
    voids[i] = measure_void(read_back, parts[i], planned, shape);
    if (drains && !voids[i].faces_centre) flaws[i] = "a triangle does not face its centre";
    if (!drains && voids[i].volume <= 0) flaws[i] = "it is not oriented inward";
    if (!flaws[i]) flaws[i] = flaw_of_place(voids[i], planned, expected.tolerance);
    if (!flaws[i] && !drains) flaws[i] = flaw_of_volume(voids[i], shape, expected.tolerance);
  });
  for (std::size_t i = 0; i < flaws.size(); ++i) {
    if (flaws[i]) fail_check("void {}: {}", i, *flaws[i]);
  }
  return voids;
}

}  // namespace aerate
