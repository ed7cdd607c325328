#include "check/check_plugs.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "check/check_failure.h"
#include "check/same_triangles.h"
#include "check/shell_topology.h"

namespace aerate {
namespace {

// Of what single precision does to coordinates, mm.
constexpr double kRounding = 1e-4;

std::span<const Triangle> triangles_of(const Mesh& mesh, const Plug& plug) {
  return std::span(mesh.triangles).subspan(plug.first_triangle, plug.triangle_count);
}

void check_shell(const Mesh& mesh, const Plug& plug, std::vector<char>& is_taken) {
  const std::size_t number = plug.hole + 1;
  if (const auto flaw = flaw_of_sphere_shell(triangles_of(mesh, plug)))
    fail_check("plug {} is no closed shell: {}", number, *flaw);
  std::vector<std::uint32_t> vertices;
  for (const Triangle& t : triangles_of(mesh, plug)) vertices.insert(vertices.end(), t.begin(), t.end());
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  float lowest = std::numeric_limits<float>::infinity();
  for (const std::uint32_t vertex : vertices) {
    if (is_taken[vertex] != 0) fail_check("plug {} touches another", number);
    is_taken[vertex] = 1;
    lowest = std::min(lowest, mesh.positions[vertex].z);
  }
  if (lowest != 0) fail_check("plug {} stands {} mm above the build plate", number, lowest);
}

// Returns the clearance.
double check_fit(const Mesh& mesh, const Plug& plug, const PlugFit& fit) {
  double widest = 0;
  for (const Triangle& t : triangles_of(mesh, plug)) {
    for (const std::uint32_t vertex : t) {
      const Vec3d from_axis = place_in_hole(plug, to_double(mesh.positions[vertex])) - plug.inner_end;
      const double along = dot(from_axis, plug.frame.axis);
      if (along < -kRounding) fail_check("plug {} is {} mm longer than its hole", plug.hole + 1, -along);
      widest = std::max(widest, length(from_axis - plug.frame.axis * along));
    }
  }
  const double clearance = plug.room - widest;
  if (clearance < fit.clearance - kRounding)
    fail_check("plug {} has a clearance of {} mm in its hole", plug.hole + 1, clearance);
  return clearance;
}

// Its vertices lie on the surface. Returns how far the middles of its triangles are off it.
double check_outer_end(const Mesh& mesh, const Plug& plug, const SurfaceIndex& surface) {
  std::vector<Vec3d> vertices, middles;
  for (const Triangle& t : triangles_of(mesh, plug).first(plug.outer_end_triangles)) {
    Vec3d sum{0, 0, 0};
    for (const std::uint32_t vertex : t) {
      vertices.push_back(place_in_hole(plug, to_double(mesh.positions[vertex])));
      sum = sum + vertices.back();
    }
    middles.push_back(sum * (1.0 / 3));
  }
  const double farthest = std::ranges::max(surface.distances(vertices));
  if (farthest > kRounding)
    fail_check("the outer end of plug {} is {} mm off the model's surface", plug.hole + 1, farthest);
  return std::ranges::max(surface.distances(middles));
}

void check_apart(const Plugs& plugs) {
  for (std::size_t i = 0; i < plugs.plugs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Plug& a = plugs.plugs[i];
      const Plug& b = plugs.plugs[j];
      if (length(a.place - b.place) < a.radius + b.radius + kPlugSpacing - kRounding)
        fail_check("plugs {} and {} stand too near to each other", b.hole + 1, a.hole + 1);
    }
  }
}

}  // namespace

PlugFacts check_plugs(const Mesh& read_back, const Plugs& plugs, const PlugFit& fit,
                      const SurfaceIndex& surface, Monitor& monitor) {
  require_same_triangles(read_back, plugs.mesh, monitor);
  std::vector<char> is_taken(read_back.positions.size(), 0);
  PlugFacts facts{.clearance = std::numeric_limits<double>::infinity()};
  for (const Plug& plug : plugs.plugs) {
    monitor.check_interrupted();
    check_shell(read_back, plug, is_taken);
    const double volume = volume_moments(read_back, triangles_of(read_back, plug), plug.place).volume;
    if (!(volume > 0)) fail_check("plug {} has no volume", plug.hole + 1);
    facts.volume += volume;
    facts.clearance = std::min(facts.clearance, check_fit(read_back, plug, fit));
    facts.flush = std::max(facts.flush, check_outer_end(read_back, plug, surface));
  }
  check_apart(plugs);
  return facts;
}

}  // namespace aerate
