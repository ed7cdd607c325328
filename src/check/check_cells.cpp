#include "check/check_cells.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <string>
#include <tbb/task_group.h>
#include <utility>
#include <vector>

#include "check/check_failure.h"
#include "check/measure_errors.h"
#include "check/polled_loop.h"
#include "check/shell_topology.h"
#include "core/facet_distance.h"
#include "mesh/inspect.h"

namespace aerate {
namespace {

constexpr std::size_t kTrianglesAtATime = std::size_t{1} << 16;

// What one void was found to be.
struct MeasuredCell {
  std::optional<std::string> flaw;
  std::uint32_t lowest_vertex = 0, end_vertex = 0;
  Box3d box{};
  VolumeMoments inside;
  double area = 0;
};

double area_of(const kernels::Facet& facet) {
  const Vec3d a = to_double(facet.a);
  return length(cross(to_double(facet.b) - a, to_double(facet.c) - a)) / 2;
}

class CellChecker {
 public:
  CellChecker(const Mesh& read_back, const Expected& expected, Monitor& monitor)
      : mesh_(read_back),
        expected_(expected),
        cells_(*expected.cells),
        monitor_(monitor),
        parts_(expected.solid.of(PartKind::void_surface)),
        origin_((to_double(bounding_box(read_back).lower) + to_double(bounding_box(read_back).upper)) * 0.5) {
  }

  MeasuredCells check() {
    measure_each();
    if (!drains()) require_own_vertices();
    MeasuredCells result;
    for (const MeasuredCell& cell : measured_) {
      result.inside.volume -= cell.inside.volume;
      result.inside.first_moment = result.inside.first_moment - cell.inside.first_moment;
    }
    for (const CellVoid& piece : cells_.voids) result.deviation = std::max(result.deviation, piece.deviation);
    // Looking for crossings takes one thread, most of the time.
    SelfIntersections crossings;
    tbb::task_group beside;
    beside.run([&] { crossings = find_crossings(); });
    result.clearances.wall = least_wall();
    result.clearances.gap = least_gap();
    beside.wait();
    require_none(crossings);
    return result;
  }

 private:
  void measure_each() {
    measured_.resize(parts_.size());
    for_each_polled(parts_.size(), kVoidsPerPiece, monitor_, [&](std::size_t i) { measure(i); });
    for (std::size_t i = 0; i < measured_.size(); ++i) {
      if (measured_[i].flaw) fail_check("void {}: {}", i, *measured_[i].flaw);
    }
  }

  void measure(std::size_t i) {
    const CellVoid& planned = cells_.voids[i];
    const std::span<const Triangle> triangles = triangles_of(mesh_, parts_[i]);
    MeasuredCell& cell = measured_[i];
    // Where it drains it is one surface with tubes and the outside, and looked at with those.
    if (!drains()) cell.flaw = flaw_of_topology(planned, triangles);
    if (cell.flaw) return;
    cell.inside = volume_moments(mesh_, triangles, origin_);
    cell.lowest_vertex = std::numeric_limits<std::uint32_t>::max();
    cell.box = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    for (const Triangle& t : triangles) {
      cell.area += area_of(facet_of(mesh_, t));
      for (const std::uint32_t v : t) {
        cell.lowest_vertex = std::min(cell.lowest_vertex, v);
        cell.end_vertex = std::max(cell.end_vertex, v + 1);
        const Vec3d p = to_double(mesh_.positions[v]);
        cell.box = {min_of(cell.box.lower, p), max_of(cell.box.upper, p)};
      }
    }
    cell.flaw = flaw_of_place(planned, triangles);
    if (!cell.flaw && !drains()) cell.flaw = flaw_of_volume(planned, cell);
  }

  bool drains() const { return expected_.drainage != nullptr; }

  static std::optional<std::string> flaw_of_topology(const CellVoid& planned,
                                                     std::span<const Triangle> triangles) {
    const SurfaceTopology topology = topology_of(triangles);
    if (topology.flaw) return topology.flaw;
    if (topology.pinch_count > 0) return "a vertex pinches it";
    if (topology.shell_count != 1) return "it surrounds solid material, which would be loose";
    if (topology.euler != planned.euler)
      return fmt::format("its Euler characteristic is {}, planned was {}", topology.euler, planned.euler);
    return std::nullopt;
  }

  std::optional<std::string> flaw_of_place(const CellVoid& planned,
                                           std::span<const Triangle> triangles) const {
    for (const Triangle& t : triangles) {
      for (const std::uint32_t v : t) {
        const Vec3d p = to_double(mesh_.positions[v]);
        for (const CellPlane& plane : cells_.planes.of(planned.cell)) {
          const double beyond = dot(plane.normal, p) - plane.offset;
          if (beyond > kLimitError)
            return fmt::format("it passes the plane towards void {} of its packing by {:.4g} mm",
                               plane.neighbour, beyond);
        }
      }
    }
    // The surface keeps away from the model's, so that one point tells for all that it is connected with.
    constexpr std::size_t kBetween = 97;
    for (std::size_t t = 0; t < triangles.size() && expected_.packing.limits.wall > 0; t += kBetween) {
      const int winding =
          expected_.surface.winding().winding_number(to_double(mesh_.positions[triangles[t][0]]));
      if (winding != 1) return fmt::format("it is where the winding number is {}", winding);
    }
    return std::nullopt;
  }

  std::optional<std::string> flaw_of_volume(const CellVoid& planned, const MeasuredCell& cell) const {
    const double volume = -cell.inside.volume;
    if (volume <= 0) return "it is not oriented inward";
    const double allowed = std::max(planned.deviation, expected_.tolerance) * cell.area;
    if (std::abs(volume - planned.planned_volume) <= allowed) return std::nullopt;
    return fmt::format("it has {:.6g} mm3, planned were {:.6g} mm3", volume, planned.planned_volume);
  }

  void require_own_vertices() const {
    std::uint32_t next = 0;
    for (const Triangle& t : triangles_of(mesh_, expected_.solid.parts.front()))
      next = std::max({next, t[0] + 1, t[1] + 1, t[2] + 1});
    for (std::size_t i = 0; i < measured_.size(); ++i) {
      if (measured_[i].lowest_vertex < next) fail_check("void {} touches another surface", i);
      next = std::max(next, measured_[i].end_vertex);
    }
  }

  double least_wall() const {
    const std::size_t first = expected_.solid.outer_triangle_count();
    const std::size_t count = parts_.empty() ? 0 : parts_.back().end() - first;
    const double wall = expected_.packing.limits.wall;
    const double looked_for = wall + expected_.tolerance;
    // Of each triangle as far as it is nearer than those before, whichever these are: the least of all is the same.
    std::atomic<double> nearest = looked_for;
    for_each_polled(count, kTrianglesAtATime, monitor_, [&](std::size_t i) {
      double known = nearest.load(std::memory_order_relaxed);
      const double distance =
          distance_to_surface(facet_of(mesh_, mesh_.triangles[first + i]), expected_.surface.bvh(), known);
      while (distance < known && !nearest.compare_exchange_weak(known, distance, std::memory_order_relaxed)) {
      }
    });
    const double least = nearest.load();
    if (least < wall - kLimitError) fail_check("the wall is {:.9g} mm, the limit {:.9g} mm", least, wall);
    return least;
  }

  // How far apart two voids are along the way between their spheres; negative if that way does not tell.
  double apart_along(std::size_t i, std::size_t j) const {
    const Vec3d from = expected_.packing.spheres[cells_.voids[i].cell].centre;
    const Vec3d to = expected_.packing.spheres[cells_.voids[j].cell].centre;
    const Vec3d way = to - from;
    if (!(length(way) > 0)) return -1;
    const Vec3d along = normalised(way);
    double farthest = -kInfinity, nearest = kInfinity;
    for (const Triangle& t : triangles_of(mesh_, parts_[i])) {
      for (const std::uint32_t v : t)
        farthest = std::max(farthest, dot(along, to_double(mesh_.positions[v])));
    }
    for (const Triangle& t : triangles_of(mesh_, parts_[j])) {
      for (const std::uint32_t v : t) nearest = std::min(nearest, dot(along, to_double(mesh_.positions[v])));
    }
    return nearest - farthest;
  }

  double distance_of(std::size_t i, std::size_t j, double looked_for) const {
    const Mesh other = submesh(mesh_, triangles_of(mesh_, parts_[j]));
    const kernels::HostTriangleBvh bvh(other.positions, other.triangles);
    double least = looked_for;
    for (const Triangle& t : triangles_of(mesh_, parts_[i]))
      least = std::min(least, distance_to_surface(facet_of(mesh_, t), bvh.view(), least));
    return least;
  }

  std::optional<double> least_gap() const {
    if (parts_.size() < 2) return std::nullopt;
    const double gap = expected_.packing.limits.gap;
    const double looked_for = gap + expected_.tolerance;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> near;
    std::vector<std::uint32_t> order(parts_.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::sort(order, {}, [&](std::uint32_t i) { return measured_[i].box.lower.x; });
    for (std::size_t a = 0; a < order.size(); ++a) {
      for (std::size_t b = a + 1; b < order.size(); ++b) {
        if (measured_[order[b]].box.lower.x > measured_[order[a]].box.upper.x + looked_for) break;
        if (distance_squared(measured_[order[a]].box, measured_[order[b]].box) < looked_for * looked_for)
          near.emplace_back(std::minmax(order[a], order[b]));
      }
    }
    std::ranges::sort(near);
    std::vector<double> distances(near.size(), looked_for);
    for_each_polled(near.size(), kVoidsPerPiece, monitor_, [&](std::size_t p) {
      const auto [i, j] = near[p];
      double apart = apart_along(i, j);
      if (apart < gap - kLimitError) apart = distance_of(i, j, looked_for);
      distances[p] = std::min(looked_for, apart);
    });
    double least = looked_for;
    for (std::size_t p = 0; p < near.size(); ++p) {
      least = std::min(least, distances[p]);
      if (distances[p] < gap - kLimitError)
        fail_check("the gap between voids {} and {} is {:.9g} mm, the limit {:.9g} mm", near[p].first,
                   near[p].second, distances[p], gap);
    }
    return least;
  }

  // Voids keep away from the model and from each other, so each can only run through itself.
  SelfIntersections find_crossings() const {
    const std::size_t first = expected_.solid.outer_triangle_count();
    return find_self_intersections(submesh(mesh_, std::span(mesh_.triangles).subspan(first)));
  }

  static void require_none(const SelfIntersections& crossings) {
    if (crossings.pair_count == 0) return;
    const Vec3d place = crossings.places.front();
    fail_check(
        "{} pairs of triangles of voids run through each other, the first near ({:.3f}, {:.3f}, {:.3f}) mm",
        crossings.pair_count, place.x, place.y, place.z);
  }

  const Mesh& mesh_;
  const Expected& expected_;
  const CellVoids& cells_;
  Monitor& monitor_;
  std::span<const SolidPart> parts_;
  Vec3d origin_;
  std::vector<MeasuredCell> measured_;
};

}  // namespace

MeasuredCells check_cells(const Mesh& read_back, const Expected& expected, Monitor& monitor) {
  return CellChecker(read_back, expected, monitor).check();
}

}  // namespace aerate
