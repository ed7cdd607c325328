#include "check/check_drained_parts.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "check/check_failure.h"
#include "check/planned_shape.h"
#include "check/polled_loop.h"
#include "core/segment_distance.h"
#include "core/void_shape.h"

namespace aerate {
namespace {

// Distances of fp32 vertices computed in fp64, relative to the radius.
constexpr double kDistanceError = 1e-9;

// Vertices on a cut were computed in fp64 and rounded to fp32: a few units in the last place of the largest
// coordinate.
constexpr double kRoundingShare = 5e-7;

constexpr double kLimitError = 1e-7;  // mm
constexpr std::size_t kPartsPerPiece = 4096;

std::span<const Triangle> part_of(const Mesh& mesh, const std::vector<std::size_t>& ends, std::size_t i,
                                  std::size_t first) {
  const std::size_t begin = i == 0 ? first : ends[i - 1];
  return std::span(mesh.triangles).subspan(begin, ends[i] - begin);
}

double rounding_of(const Mesh& mesh, const Triangle& t) {
  double largest = 1;
  for (const std::uint32_t v : t) {
    const Vec3d p = to_double(mesh.positions[v]);
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  return kRoundingShare * largest;
}

struct VoidFinding {
  double radius = 0;  // of the least void that holds it
  double depth = 0;
  bool faces_centre = true;
};

VoidFinding look_at_void(const Mesh& mesh, std::span<const Triangle> triangles, const Roof& roof,
                         const Sphere& planned) {
  VoidFinding found;
  PlannedShape shape(roof, planned);
  for (const Triangle& t : triangles) {
    const kernels::Facet facet{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    const Vec3d a = to_double(facet.a) - planned.centre;
    const Vec3d b = to_double(facet.b) - planned.centre;
    const Vec3d c = to_double(facet.c) - planned.centre;
    for (const Vec3f& p : {facet.a, facet.b, facet.c}) shape.hold(p);
    // Seen from the centre a triangle that faces it runs clockwise.
    if (!(dot(a, cross(b, c)) < 0)) found.faces_centre = false;
    found.depth = std::max(found.depth, shape.depth(facet));
  }
  found.radius = shape.radius();
  return found;
}

// What is wrong with the part of a tube.
std::optional<std::string> flaw_of_tube(const Mesh& mesh, std::span<const Triangle> triangles,
                                        const Tube& tube) {
  const Vec3d along = tube.end - tube.start;
  const Vec3d axis = along * (1 / length(along));
  const auto from_axis = [&](Vec3d p) {
    const Vec3d from_start = p - tube.start;
    return from_start - axis * dot(from_start, axis);
  };
  if (triangles.empty()) return "it is missing";
  for (const Triangle& t : triangles) {
    const double most = tube.radius + rounding_of(mesh, t);
    for (const std::uint32_t v : t) {
      const double distance = length(from_axis(to_double(mesh.positions[v])));
      if (distance > most)
        return fmt::format("it reaches {:.9g} mm from its axis, planned were {:.9g} mm", distance,
                           tube.radius);
    }
    const Vec3d a = to_double(mesh.positions[t[0]]), b = to_double(mesh.positions[t[1]]),
                c = to_double(mesh.positions[t[2]]);
    const Vec3d outwards = from_axis((a + b + c) * (1.0 / 3));
    if (dot(cross(b - a, c - a), outwards) >= 0) return "a triangle does not face its axis";
  }
  return std::nullopt;
}

void require_spacing(const Tube& a, const Tube& b, double spacing) {
  const double distance = distance_between({a.start, a.end}, {b.start, b.end}) - a.radius - b.radius;
  if (distance < spacing - kLimitError)
    fail_check("two channels or holes are {:.9g} mm from each other, the limit is {:.9g} mm", distance,
               spacing);
}

struct PlacedTube {
  const Tube* tube;
  std::uint32_t from, to;
  bool shares_void_with(const PlacedTube& other) const {
    return from == other.from || from == other.to || to == other.from || to == other.to;
  }
};

}  // namespace

DrainedParts check_drained_parts(const Mesh& mesh, const DrainedSolid& solid, std::span<const Sphere> balls,
                                 const DrainagePlan& plan, double tolerance, Monitor& monitor) {
  if (solid.void_ends.size() != balls.size() || solid.channel_ends.size() != plan.channels.size() ||
      solid.hole_ends.size() != plan.holes.size())
    fail_check("{} voids, {} channels and {} holes were planned; {}, {} and {} made", balls.size(),
               plan.channels.size(), plan.holes.size(), solid.void_ends.size(), solid.channel_ends.size(),
               solid.hole_ends.size());

  std::vector<VoidFinding> voids(balls.size());
  for_each_polled(balls.size(), kPartsPerPiece, monitor, [&](std::size_t i) {
    voids[i] = look_at_void(mesh, part_of(mesh, solid.void_ends, i, solid.outer_triangle_count), plan.roof,
                            balls[i]);
  });
  DrainedParts parts;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const double slack = balls[i].radius * kDistanceError;
    if (!voids[i].faces_centre) fail_check("void {}: a triangle does not face its centre", i);
    if (voids[i].radius > balls[i].radius + slack)
      fail_check("void {}: it has radius {:.9g} mm, planned were {:.9g} mm", i, voids[i].radius,
                 balls[i].radius);
    if (voids[i].depth > tolerance + slack)
      fail_check("void {}: it stays {:.9g} mm inside its planned shape, the tolerance is {:.9g} mm", i,
                 voids[i].depth, tolerance);
    parts.balls.push_back({balls[i].centre, voids[i].radius, balls[i].kind});
    parts.depth = std::max(parts.depth, voids[i].depth);
  }
  const std::size_t first_channel = balls.empty() ? solid.outer_triangle_count : solid.void_ends.back();
  for (std::size_t i = 0; i < plan.channels.size(); ++i) {
    const auto flaw =
        flaw_of_tube(mesh, part_of(mesh, solid.channel_ends, i, first_channel), plan.channels[i].tube);
    if (flaw) fail_check("channel {}: {}", i, *flaw);
    const Channel& channel = plan.channels[i];
    const VoidShape from(balls[channel.from], plan.roof), to(balls[channel.to], plan.roof);
    if (!from.may_open(channel.tube, TubeEnd::start) || !to.may_open(channel.tube, TubeEnd::end))
      fail_check("channel {}: it opens into a roof", i);
  }
  const std::size_t first_hole = plan.channels.empty() ? first_channel : solid.channel_ends.back();
  for (std::size_t i = 0; i < plan.holes.size(); ++i) {
    const auto flaw = flaw_of_tube(mesh, part_of(mesh, solid.hole_ends, i, first_hole), plan.holes[i].tube);
    if (flaw) fail_check("escape hole {}: {}", i, *flaw);
    const VoidShape from(balls[plan.holes[i].from], plan.roof);
    if (!from.opens_below_roof(plan.holes[i].tube, TubeEnd::start))
      fail_check("escape hole {}: it opens into a roof", i);
  }
  return parts;
}

void check_tube_gaps(std::span<const Sphere> balls, const DrainagePlan& plan, double gap) {
  std::vector<PlacedTube> tubes;
  for (const Channel& channel : plan.channels) tubes.push_back({&channel.tube, channel.from, channel.to});
  for (const EscapeHole& hole : plan.holes) tubes.push_back({&hole.tube, hole.from, hole.from});
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    const Tube& tube = *tubes[i].tube;
    for (std::uint32_t ball = 0; ball < balls.size(); ++ball) {
      if (ball == tubes[i].from || ball == tubes[i].to) continue;
      const double distance =
          VoidShape(balls[ball], plan.roof).distance_to({tube.start, tube.end}) - tube.radius;
      if (distance < gap - kLimitError)
        fail_check("a channel or hole is {:.9g} mm from void {}, the gap is {:.9g} mm", distance, ball, gap);
    }
    for (std::size_t j = 0; j < i; ++j)
      require_spacing(tube, *tubes[j].tube, tubes[i].shares_void_with(tubes[j]) ? 0 : gap);
  }
}

}  // namespace aerate
