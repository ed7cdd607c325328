#include "printing/plugs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "core/segment_distance.h"
#include "printing/plug_surface.h"

namespace aerate {
namespace {

constexpr std::size_t kPlugsInRow = 10;

// In the frame of a hole.
Vec3d seen_along(const TubeFrame& frame, Vec3d origin, Vec3d point) {
  const Vec3d from_origin = point - origin;
  return {dot(from_origin, frame.down), dot(from_origin, frame.across), dot(from_origin, frame.axis)};
}

// A hole as it was made.
struct MadeHole {
  double room = std::numeric_limits<double>::infinity();  // see Plug
  // Along the axis: from here on there is wall on one side, and from there on all round.
  double wall_begins = std::numeric_limits<double>::infinity();
  double wall_all_round = -std::numeric_limits<double>::infinity();
};

MadeHole measure(const Solid& solid, const SolidPart& part, const std::vector<char>& is_of_void,
                 const TubeFrame& frame, Vec3d origin) {
  MadeHole made;
  for (const Triangle& t : triangles_of(solid.mesh, part)) {
    std::array<Vec3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = seen_along(frame, origin, to_double(solid.mesh.positions[t[k]]));
      if (is_of_void[t[k]] != 0) {
        made.wall_begins = std::min(made.wall_begins, corners[k].z);
        made.wall_all_round = std::max(made.wall_all_round, corners[k].z);
      }
      corners[k].z = 0;
    }
    for (std::size_t k = 0; k < 3; ++k)
      made.room = std::min(made.room, distance_to_point({corners[k], corners[(k + 1) % 3]}, {0, 0, 0}));
  }
  return made;
}

// The surface of a model over a plane across a hole.
class SurfaceAbove {
 public:
  SurfaceAbove(const Mesh& model, std::span<const std::uint32_t> triangles, const TubeFrame& frame,
               Vec3d origin) {
    for (const std::uint32_t index : triangles) {
      std::array<Vec3d, 3> corners;
      for (std::size_t k = 0; k < 3; ++k)
        corners[k] = seen_along(frame, origin, to_double(model.positions[model.triangles[index][k]]));
      triangles_.push_back(corners);
    }
  }

  // Of its lowest point over the plane, if there is one.
  std::optional<double> height(double x, double y) const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const auto& corners : triangles_) {
      const double found = height_of(corners, x, y);
      if (found > 0) lowest = std::min(lowest, found);
    }
    return std::isfinite(lowest) ? std::optional(lowest) : std::nullopt;
  }

 private:
  // Of a triangle, or -1 beside it.
  static double height_of(const std::array<Vec3d, 3>& corners, double x, double y) {
    std::array<double, 3> weights{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& a = corners[(k + 1) % 3];
      const Vec3d& b = corners[(k + 2) % 3];
      weights[k] = (a.x - x) * (b.y - y) - (a.y - y) * (b.x - x);
    }
    const double sum = weights[0] + weights[1] + weights[2];
    if (sum == 0) return -1;
    // A point on an edge is on both sides' triangles, whatever rounding says.
    constexpr double kBeside = -1e-9;
    for (const double weight : weights)
      if (weight / sum < kBeside) return -1;
    return (weights[0] * corners[0].z + weights[1] * corners[1].z + weights[2] * corners[2].z) / sum;
  }

  std::vector<std::array<Vec3d, 3>> triangles_;
};

// Adds a shell on the build plate, about the plug's place.
void add_shell(Plugs& plugs, Plug plug, const PlugSurface& surface) {
  const auto first = static_cast<std::uint32_t>(plugs.mesh.positions.size());
  for (const Vec3d position : surface.positions)
    plugs.mesh.positions.push_back(to_float(position + plug.place));
  plug.first_triangle = plugs.mesh.triangles.size();
  plug.triangle_count = surface.triangles.size();
  for (const Triangle& t : surface.triangles)
    plugs.mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  plugs.plugs.push_back(plug);
}

// Behind the last one in its row, or at the beginning of a new row above it.
Vec3d next_place(const Plugs& plugs, double radius, double row_width) {
  if (plugs.plugs.empty()) return {radius, row_width / 2, 0};
  const Plug& last = plugs.plugs.back();
  if (plugs.plugs.size() % kPlugsInRow == 0) return {radius, last.place.y + row_width + kPlugSpacing, 0};
  return {last.place.x + last.radius + kPlugSpacing + radius, last.place.y, 0};
}

}  // namespace

Vec3d place_in_hole(const Plug& plug, Vec3d printed) {
  const Vec3d own = printed - plug.place;
  return plug.inner_end + plug.frame.down * own.x + plug.frame.across * own.y + plug.frame.axis * own.z;
}

Plugs make_plugs(const Mesh& model, const SurfaceIndex& surface, const Solid& solid, const DrainagePlan& plan,
                 const PlugFit& fit) {
  std::vector<char> is_of_void(solid.mesh.positions.size(), 0);
  for (const SolidPart& part : solid.of(PartKind::void_surface))
    for (const Triangle& t : triangles_of(solid.mesh, part))
      for (const std::uint32_t vertex : t) is_of_void[vertex] = 1;
  double widest = 0;
  for (const EscapeHole& hole : plan.holes) widest = std::max(widest, hole.tube.radius);

  Plugs plugs;
  for (std::size_t i = 0; i < plan.holes.size(); ++i) {
    const Tube& tube = plan.holes[i].tube;
    Plug plug{.hole = i, .frame = frame_of(tube, plan.roof.up)};
    const MadeHole made = measure(solid, solid.of(PartKind::hole)[i], is_of_void, plug.frame, tube.start);
    plug.room = made.room;
    plug.radius = made.room - fit.clearance;
    const Vec3d beyond = tube.end + plug.frame.axis * (kCutBeyond * tube.radius);
    const std::vector<std::uint32_t> near = surface.triangles_near({tube.start, beyond}, tube.radius);
    std::optional<PlugSurface> shell;
    // All the tube is free; a plug that is too short within the wall reaches out of it on one side.
    for (const double share : {1.0, 0.5, 0.0}) {
      if (shell || !(plug.radius > 0) || !(made.wall_begins <= made.wall_all_round)) break;
      plug.inner_end = tube.start + plug.frame.axis * std::lerp(made.wall_begins, made.wall_all_round, share);
      const SurfaceAbove above(model, near, plug.frame, plug.inner_end);
      shell = plug_surface({.radius = plug.radius,
                            .tangent = std::tan(fit.taper_degrees * std::numbers::pi / 180),
                            .number = i + 1,
                            .height = [&](double x, double y) { return above.height(x, y); }});
    }
    if (!shell) {
      plugs.without.push_back(i);
      continue;
    }
    plug.outer_end_triangles = shell->outer_end_triangles;
    plug.inner_radius = shell->inner_radius;
    plug.shortest = shell->shortest;
    plug.longest = shell->longest;
    plug.is_numbered = shell->is_numbered;
    plug.place = next_place(plugs, plug.radius, 2 * widest);
    add_shell(plugs, plug, *shell);
  }
  return plugs;
}

}  // namespace aerate
