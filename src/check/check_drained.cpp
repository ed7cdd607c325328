#include "check/check_drained.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>
#include <vector>

#include "check/ceilings.h"
#include "check/check_drained_parts.h"
#include "check/check_failure.h"
#include "check/mesh_part.h"
#include "check/outward_shells.h"
#include "check/planned_shape.h"
#include "check/same_triangles.h"
#include "core/segment_distance.h"
#include "mesh/topology.h"
#include "packing/verify.h"

namespace aerate {
namespace {

// Sums of fp64 terms over millions of triangles: relative to the volume that they add up to.
constexpr double kSummationError = 1e-9;

constexpr double kLimitError = 1e-7;  // mm

// Vertices on a cut, rounded to fp32: a few units in the last place of the largest coordinate.
constexpr double kRoundingShare = 5e-7;

// With a hole triangles are cut that are a thousandth of a millimetre beyond it.
constexpr double kCutMargin = 2e-3;

// How far round a hole triangles are looked at, mm.
constexpr double kNeighbourhood = 0.5;

// Points along a channel at which its wall is measured are so far apart, mm: between them it may be less by
// half of that.
constexpr double kSpacing = 0.05;

double rounding_of(const Mesh& mesh) {
  const Box3f box = bounding_box(mesh);
  double largest = 1;
  for (const Vec3d p : {to_double(box.lower), to_double(box.upper)})
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return kRoundingShare * largest;
}

Vec3d axis_of(const Tube& tube) {
  const Vec3d along = tube.end - tube.start;
  return along * (1 / length(along));
}

Segment cut_of(const Tube& tube) {
  return {tube.start, tube.end + axis_of(tube) * (kCutBeyond * tube.radius)};
}

// Where a hole has come out, as far from the surface as it is wide.
Vec3d mouth_of(const Tube& tube) {
  return tube.end + axis_of(tube) * tube.radius;
}

kernels::Facet facet_of(const Mesh& mesh, const Triangle& t) {
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

// The model's triangles but the cut ones, in their order.
void require_kept_outer(const Mesh& read_back, const ExpectedDrained& expected) {
  const std::vector<std::uint32_t>& cut = expected.solid.cut_triangles;
  const std::size_t count = expected.model.triangles.size();
  if (expected.solid.kept_triangle_count + cut.size() != count)
    fail_check("{} triangles of the model were kept and {} cut, it has {}",
               expected.solid.kept_triangle_count, cut.size(), count);
  std::size_t next_cut = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (next_cut < cut.size() && cut[next_cut] == i) {
      ++next_cut;
    } else if (!has_same_corners(read_back, i - next_cut, expected.model, i)) {
      fail_check("triangle {} is not the one of the model", i - next_cut);
    }
  }
  if (next_cut != cut.size()) fail_check("the cut triangles are not in order");
}

void require_cuts_at_holes(const ExpectedDrained& expected) {
  for (const std::uint32_t i : expected.solid.cut_triangles) {
    const kernels::Facet facet = facet_of(expected.model, expected.model.triangles[i]);
    const bool is_at_hole =
        std::any_of(expected.plan.holes.begin(), expected.plan.holes.end(), [&](const EscapeHole& hole) {
          return distance_to_facet(cut_of(hole.tube), facet) < hole.tube.radius + kCutMargin;
        });
    if (!is_at_hole) fail_check("triangle {} of the model was cut away from every escape hole", i);
  }
}

// What is left of cut triangles lies in the model's surface.
void require_remains_on_surface(const Mesh& read_back, const ExpectedDrained& expected) {
  std::vector<Vec3d> corners;
  for (std::size_t i = expected.solid.kept_triangle_count; i < expected.solid.outer_triangle_count; ++i) {
    for (const std::uint32_t v : read_back.triangles[i]) corners.push_back(to_double(read_back.positions[v]));
  }
  double farthest = 0;
  for (const double distance : expected.surface.distances(corners)) farthest = std::max(farthest, distance);
  if (farthest > rounding_of(expected.model))
    fail_check("the outer surface beside a hole is {:.3g} mm from the model's", farthest);
}

// Edges by kind, and vertices - edges + triangles.
struct EdgeCounts {
  std::size_t open = 0, misoriented = 0, non_manifold = 0;
  std::int64_t euler = 0;

  EdgeCounts operator+(const EdgeCounts& other) const {
    return {open + other.open, misoriented + other.misoriented, non_manifold + other.non_manifold,
            euler + other.euler};
  }
};
EdgeCounts count_edges(const Mesh& mesh, const EdgeUses& uses) {
  std::vector<bool> is_used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) is_used[v] = true;
  }
  EdgeCounts without_edges;
  without_edges.euler =
      std::count(is_used.begin(), is_used.end(), true) + static_cast<std::int64_t>(mesh.triangles.size());
  const auto add_edges = [&](const tbb::blocked_range<std::size_t>& rows, EdgeCounts counts) {
    for (std::size_t low = rows.begin(); low != rows.end(); ++low) {
      uses.for_each_edge(low, [&](std::uint32_t from, std::uint32_t, std::span<const EdgeUse> edge) {
        const EdgeBalance balance = balance_of(mesh, from, edge);
        counts.open += balance.is_open() ? 1U : 0U;
        counts.misoriented += balance.is_misoriented() ? 1U : 0U;
        counts.non_manifold += balance.is_non_manifold() ? 1U : 0U;
        --counts.euler;
      });
    }
    return counts;
  };
  return without_edges + tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, uses.row_count()),
                                              EdgeCounts{}, add_edges, std::plus<>());
}

// What is found out about edges and shells as wholes.
struct Topology {
  EdgeCounts edges, edges_of_model;
  ShellLabels labels;
  std::vector<Shell> shells;
};
Topology find_topology(const Mesh& read_back, const Mesh& model) {
  Topology topology;
  const EdgeUses uses(read_back);
  tbb::parallel_invoke([&] { topology.edges = count_edges(read_back, uses); },
                       [&] { topology.edges_of_model = count_edges(model, EdgeUses(model)); },
                       [&] {
                         topology.labels = label_shells(read_back, uses);
                         topology.shells = describe_shells(read_back, topology.labels);
                       });
  return topology;
}

void require_sound_edges(const Topology& topology, const ExpectedDrained& expected) {
  const EdgeCounts& counts = topology.edges;
  const EdgeCounts& model = topology.edges_of_model;
  if (counts.open > 0) fail_check("it has {} open edges", counts.open);
  if (counts.misoriented > 0) fail_check("it has {} misoriented edges", counts.misoriented);
  if (counts.non_manifold > model.non_manifold)
    fail_check("it has {} non-manifold edges, the model has {}", counts.non_manifold, model.non_manifold);
  // A void adds a sphere (2); a tube takes a disc at either end (-2), and is a cylinder (0).
  const auto tubes = static_cast<std::int64_t>(expected.plan.channels.size() + expected.plan.holes.size());
  const std::int64_t planned = model.euler + 2 * static_cast<std::int64_t>(expected.balls.size()) - 2 * tubes;
  if (counts.euler != planned)
    fail_check(
        "its Euler characteristic is {} instead of {}: voids, channels and holes do not join as planned",
        counts.euler, planned);
}

// Shells with inner surface that are inward, so that nothing joins them to the outside; and holes that open
// into a cavity of the model.
std::size_t count_sealed(const Mesh& read_back, const Topology& topology, const ExpectedDrained& expected) {
  const ShellLabels& labels = topology.labels;
  std::vector<bool> is_sealed(labels.count, false);
  for (std::size_t i = expected.solid.outer_triangle_count; i < read_back.triangles.size(); ++i) {
    const std::uint32_t label = labels.of_triangle[i];
    if (label == kNoShell) fail_check("triangle {} belongs to no shell", i);
    if (topology.shells[label].volume <= 0) is_sealed[label] = true;
  }
  const OutwardShells outward(expected.model, expected.inspection, expected.surface);
  const auto is_shut_in = [&](const EscapeHole& hole) {
    return outward.winding().winding_number(mouth_of(hole.tube)) != 0;
  };
  return static_cast<std::size_t>(
      std::count(is_sealed.begin(), is_sealed.end(), true) +
      std::count_if(expected.plan.holes.begin(), expected.plan.holes.end(), is_shut_in));
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
        "{} pairs of triangles intersect at escape hole {}, the first near ({:.3f}, {:.3f}, {:.3f}) mm",
        crossings[i].pair_count, i, place.x, place.y, place.z);
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

// Balls and channels outside them, and holes to where their cut ends.
double most_removed(const ExpectedDrained& expected) {
  double volume = 0;
  for (const Sphere& ball : expected.balls) volume += void_volume(expected.plan.roof, ball.radius);
  const auto add = [&](const Tube& tube, double beyond) {
    volume +=
        std::numbers::pi * tube.radius * tube.radius * (length(tube.end - tube.start) + beyond * tube.radius);
  };
  for (const Channel& channel : expected.plan.channels) add(channel.tube, 0);
  for (const EscapeHole& hole : expected.plan.holes) add(hole.tube, kCutBeyond);
  return volume;
}

double least_removed(const ExpectedDrained& expected) {
  double volume = 0;
  for (const Sphere& ball : expected.balls) {
    const PlannedShape shape(expected.plan.roof, ball);
    volume += shape.volume_within(expected.tolerance);
  }
  return volume;
}

void measure_volumes(const Mesh& read_back, const ExpectedDrained& expected, OutputFacts& facts) {
  const VolumeMoments outer = volume_moments(expected.model);
  const VolumeMoments whole = volume_moments(read_back);
  facts.volume_removed = outer.volume - whole.volume;
  const double error = kSummationError * outer.volume;
  if (facts.volume_removed < least_removed(expected) - error ||
      facts.volume_removed > most_removed(expected) + error)
    fail_check("{:.9g} mm3 are removed, planned were {:.9g} to {:.9g}", facts.volume_removed,
               least_removed(expected), most_removed(expected));
  // With overlapping parts the signed volume counts the overlap twice; a slicer fills it once.
  const bool overlapping = expected.inspection.parts_overlap();
  facts.volume_before = overlapping ? expected.inspection.filled_volume : outer.volume;
  facts.volume_after = facts.volume_before - facts.volume_removed;
  if (overlapping) return;
  facts.centre_of_mass_before = outer.first_moment * (1 / outer.volume);
  facts.centre_of_mass_after = whole.first_moment * (1 / whole.volume);
}

Clearances measure_limits(const std::vector<Sphere>& balls, const ExpectedDrained& expected) {
  const Clearances clearances = measure_clearances(expected.surface, balls, expected.plan.roof);
  if (clearances.wall < expected.limits.wall - kLimitError)
    fail_check("the wall is {:.9g} mm, the limit {:.9g} mm", clearances.wall, expected.limits.wall);
  if (clearances.gap && *clearances.gap < expected.limits.gap - kLimitError)
    fail_check("the gap is {:.9g} mm, the limit {:.9g} mm", *clearances.gap, expected.limits.gap);
  return clearances;
}

// Of all inner surface: voids, channels and holes.
std::optional<Ceilings> measure_limited_ceilings(const Mesh& read_back, const ExpectedDrained& expected,
                                                 Monitor& monitor) {
  const Roof& roof = expected.plan.roof;
  if (!roof.limits_ceilings()) return std::nullopt;
  const std::size_t first = expected.solid.outer_triangle_count;
  const std::vector<ShellRange> inner{{first, read_back.triangles.size() - first, 0, 0}};
  const Ceilings ceilings = measure_ceilings(read_back, inner, roof, monitor);
  require_bridged(ceilings, roof, expected.tolerance);
  return ceilings;
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

OutputFacts check_drained(const Mesh& read_back, const ExpectedDrained& expected, DrainageFacts& drainage,
                          Monitor& monitor) {
  const DrainedSolid& solid = expected.solid;
  require_same_triangles(read_back, solid.mesh, "the result", monitor);
  if (read_back.triangles.size() != solid.mesh.triangles.size())
    fail_check("it has {} triangles too many", read_back.triangles.size() - solid.mesh.triangles.size());
  if (!expected.inspection.closed()) fail_check("the outer surface is not closed");
  require_kept_outer(read_back, expected);
  require_cuts_at_holes(expected);
  require_remains_on_surface(read_back, expected);
  monitor.check_interrupted();

  const DrainedParts parts =
      check_drained_parts(read_back, solid, expected.balls, expected.plan, expected.tolerance, monitor);
  check_tube_gaps(expected.balls, expected.plan, expected.limits.gap);
  drainage.channel_wall = channel_wall(expected.surface, expected.plan);
  if (drainage.channel_wall < expected.limits.wall - kSpacing / 2 - kLimitError)
    fail_check("the wall beside a channel is {:.9g} mm, the limit {:.9g} mm", drainage.channel_wall,
               expected.limits.wall);
  monitor.check_interrupted();

  const Topology topology = find_topology(read_back, expected.model);
  require_sound_edges(topology, expected);
  monitor.check_interrupted();
  drainage.sealed_cavities = count_sealed(read_back, topology, expected);
  if (drainage.sealed_cavities > 0) fail_check("{} cavities are sealed", drainage.sealed_cavities);
  require_no_crossings(read_back, expected.plan);
  monitor.check_interrupted();

  drainage.cut_triangles = solid.cut_triangles.size();
  drainage.cavities_of_model = static_cast<std::size_t>(
      std::count_if(expected.inspection.shells.begin(), expected.inspection.shells.end(),
                    [](const Shell& shell) { return shell.volume < 0; }));

  OutputFacts facts;
  facts.triangle_count = read_back.triangles.size();
  facts.outer_triangle_count = solid.outer_triangle_count;
  facts.void_triangle_count = facts.triangle_count - facts.outer_triangle_count;
  facts.void_count = parts.balls.size();
  facts.smallest_radius = std::numeric_limits<double>::infinity();
  for (const Sphere& ball : parts.balls) {
    facts.smallest_radius = std::min(facts.smallest_radius, ball.radius);
    facts.largest_radius = std::max(facts.largest_radius, ball.radius);
  }
  facts.void_deviation = parts.depth;
  facts.roof_count = static_cast<std::size_t>(
      std::count_if(expected.balls.begin(), expected.balls.end(),
                    [&](const Sphere& ball) { return expected.plan.roof.shapes(ball.radius); }));
  facts.ceilings = measure_limited_ceilings(read_back, expected, monitor);
  facts.clearances = measure_limits(parts.balls, expected);
  measure_volumes(read_back, expected, facts);
  return facts;
}

}  // namespace aerate
