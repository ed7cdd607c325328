#include "check/check_tubes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "check/check_failure.h"
#include "check/measure_errors.h"
#include "check/tube_cut.h"
#include "core/segment_distance.h"
#include "core/void_shape.h"

namespace aerate {
namespace {

// Points along a channel at which its wall is measured are so far apart, mm: between them it may be less by
// half of that.
constexpr double kSpacing = 0.05;

double rounding_of(const Mesh& mesh, const Triangle& t) {
  double largest = 1;
  for (const std::uint32_t v : t) {
    const Vec3d p = to_double(mesh.positions[v]);
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  return kRoundingShare * largest;
}

// What is wrong with the part of a tube.
std::optional<std::string> flaw_of_tube(const Mesh& mesh, const SolidPart& part, const Tube& tube) {
  const Vec3d axis = direction_of(tube);
  const auto from_axis = [&](Vec3d p) {
    const Vec3d from_start = p - tube.start;
    return from_start - axis * dot(from_start, axis);
  };
  if (part.triangle_count == 0) return "it is missing";
  for (const Triangle& t : triangles_of(mesh, part)) {
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

// Voids are opened below their roofs, or straight up out of their tops.
void require_below_roof(const Packing& packing, const Channel& channel, std::size_t i) {
  const VoidShape from(packing.spheres[channel.from], packing.limits.roof);
  const VoidShape to(packing.spheres[channel.to], packing.limits.roof);
  if (!from.may_open(channel.tube, TubeEnd::start) || !to.may_open(channel.tube, TubeEnd::end))
    fail_check("channel {}: it opens into a roof", i);
}

void require_below_roof(const Packing& packing, const EscapeHole& hole, std::size_t i) {
  const VoidShape from(packing.spheres[hole.from], packing.limits.roof);
  if (!from.opens_below_roof(hole.tube, TubeEnd::start))
    fail_check("escape hole {}: it opens into a roof", i);
}

template <typename Way>
void check_parts(const Mesh& read_back, std::span<const SolidPart> parts, const std::vector<Way>& ways,
                 const char* what, const Packing* packing) {
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const auto flaw = flaw_of_tube(read_back, parts[i], ways[i].tube);
    if (flaw) fail_check("{} {}: {}", what, i, *flaw);
    if (packing != nullptr) require_below_roof(*packing, ways[i], i);
  }
}

// How far a tube's axis is from voids, by their number; not for those that it leads to.
double distance_to_ball(const Expected& expected, std::size_t ball, const Tube& tube) {
  return VoidShape(expected.packing.spheres[ball], expected.packing.limits.roof)
      .distance_to({tube.start, tube.end});
}

class CellDistances {
 public:
  CellDistances(const Mesh& read_back, const Expected& expected) : mesh_(read_back) {
    for (const SolidPart& part : expected.solid.of(PartKind::void_surface)) {
      Box3f box = kernels::empty_box();
      for (const Triangle& t : triangles_of(read_back, part))
        box = kernels::united(box, kernels::box_of(facet_of(read_back, t)));
      parts_.push_back({part, box});
    }
  }

  // No less than `looked_for` is told apart.
  double operator()(std::size_t cell, const Tube& tube, double looked_for) const {
    const auto& [part, box] = parts_[cell];
    const Vec3d middle = (tube.start + tube.end) * 0.5;
    const double reach = looked_for + length(tube.end - tube.start) / 2;
    if (kernels::distance_squared_to_box(middle, box) > reach * reach) return looked_for;
    double least = looked_for;
    for (const Triangle& t : triangles_of(mesh_, part))
      least = std::min(least, distance_to_facet({tube.start, tube.end}, facet_of(mesh_, t)));
    return least;
  }

 private:
  const Mesh& mesh_;
  std::vector<std::pair<SolidPart, Box3f>> parts_;
};

// Tubes keep the gap from voids that they do not lead to, and from each other; those that lead to the same
// void only have to be apart.
void require_gaps(const Mesh& read_back, const Expected& expected) {
  const DrainagePlan& plan = *expected.drainage;
  const double gap = expected.packing.limits.gap;
  std::vector<PlacedTube> tubes;
  for (const Channel& channel : plan.channels) tubes.push_back({&channel.tube, channel.from, channel.to});
  for (const EscapeHole& hole : plan.holes) tubes.push_back({&hole.tube, hole.from, hole.from});
  std::optional<CellDistances> to_cells;
  if (expected.cells != nullptr) to_cells.emplace(read_back, expected);
  const std::size_t voids = expected.solid.of(PartKind::void_surface).size();
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    const Tube& tube = *tubes[i].tube;
    for (std::size_t other = 0; other < voids; ++other) {
      if (other == tubes[i].from || other == tubes[i].to) continue;
      const double distance = (to_cells ? (*to_cells)(other, tube, gap + tube.radius + 1)
                                        : distance_to_ball(expected, other, tube)) -
                              tube.radius;
      if (distance < gap - kLimitError)
        fail_check("a channel or hole is {:.9g} mm from void {}, the gap is {:.9g} mm", distance, other, gap);
    }
    for (std::size_t j = 0; j < i; ++j)
      require_spacing(tube, *tubes[j].tube, tubes[i].shares_void_with(tubes[j]) ? 0 : gap);
  }
}

// Least distance between the channels' sides and the surface, and no less than it is by half of kSpacing.
double channel_wall(const SurfaceIndex& surface, const DrainagePlan& plan) {
  double least = std::numeric_limits<double>::infinity();
  for (const Channel& channel : plan.channels) {
    const Vec3d along = channel.tube.end - channel.tube.start;
    const auto steps = static_cast<std::size_t>(std::ceil(length(along) / kSpacing)) + 1;
    for (std::size_t i = 0; i <= steps; ++i) {
      const Vec3d point = channel.tube.start + along * (static_cast<double>(i) / static_cast<double>(steps));
      // Only what is nearer than the least so far is of interest.
      const double limit = least + channel.tube.radius;
      const double nearest = surface.bvh().nearest(point, limit * limit).distance_squared;
      least = std::min(least, std::sqrt(nearest) - channel.tube.radius);
    }
  }
  return least - kSpacing / 2;
}

}  // namespace

double check_tubes(const Mesh& read_back, const Expected& expected) {
  const DrainagePlan& plan = *expected.drainage;
  const Packing& packing = expected.packing;
  const Packing* roofed =
      expected.cells == nullptr ? &packing : nullptr;  // cells have no roofs to open below
  check_parts(read_back, expected.solid.of(PartKind::channel), plan.channels, "channel", roofed);
  check_parts(read_back, expected.solid.of(PartKind::hole), plan.holes, "escape hole", roofed);
  require_gaps(read_back, expected);
  const double wall = channel_wall(expected.surface, plan);
  if (wall < packing.limits.wall - kSpacing / 2 - kLimitError)
    fail_check("the wall beside a channel is {:.9g} mm, the limit {:.9g} mm", wall, packing.limits.wall);
  return wall;
}

}  // namespace aerate
