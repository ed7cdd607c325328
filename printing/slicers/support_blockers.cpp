#include "printing/slicers/support_blockers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace aerate {
namespace {

constexpr double kFarthest = 1.5;  // that a vertex moves, of what facets do

// Unit normal; zero for a triangle without area.
Vec3d normal_of(const Mesh& mesh, const Triangle& t) {
  const Vec3d a = to_double(mesh.positions[t[0]]), b = to_double(mesh.positions[t[1]]),
              c = to_double(mesh.positions[t[2]]);
  const Vec3d normal = cross(b - a, c - a);
  const double size = length(normal);
  return size > 0 ? normal * (1 / size) : Vec3d{0, 0, 0};
}

double angle_at(const Mesh& mesh, const Triangle& t, std::size_t corner) {
  const Vec3d at = to_double(mesh.positions[t[corner]]);
  const Vec3d u = to_double(mesh.positions[t[(corner + 1) % 3]]) - at,
              v = to_double(mesh.positions[t[(corner + 2) % 3]]) - at;
  return std::atan2(length(cross(u, v)), dot(u, v));
}

// At each vertex the mean of the facets' normals, by their angles; zero where there is none.
std::vector<Vec3d> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3d> normals(mesh.positions.size(), Vec3d{0, 0, 0});
  for (const Triangle& t : mesh.triangles) {
    const Vec3d normal = normal_of(mesh, t);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Vec3d& sum = normals[t[corner]];
      sum = sum + normal * angle_at(mesh, t, corner);
    }
  }
  for (Vec3d& normal : normals) {
    const double size = length(normal);
    if (size > 0) normal = normal * (1 / size);
  }
  return normals;
}

}  // namespace

double growth_of_blockers(double wall) {
  return wall / (2 * kFarthest);
}

Mesh grown(Mesh shell, double by) {
  const std::vector<Vec3d> normals = vertex_normals(shell);
  // How much of a vertex's way each facet goes along its own normal, at least.
  std::vector<double> share(normals.size(), 1);
  for (const Triangle& t : shell.triangles) {
    const Vec3d normal = normal_of(shell, t);
    if (normal == Vec3d{0, 0, 0}) continue;
    for (const std::uint32_t v : t) share[v] = std::min(share[v], dot(normals[v], normal));
  }
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const double way = by / std::max(share[v], 1 / kFarthest);
    shell.positions[v] = to_float(to_double(shell.positions[v]) + normals[v] * way);
  }
  return shell;
}

Mesh with_support_blockers(const Solid& solid, double growth) {
  Mesh mesh = solid.mesh;
  mesh.triangles.reserve(2 * mesh.triangles.size() - solid.outer_triangle_count());
  for (const SolidPart& part : solid.of(PartKind::void_surface)) {
    Mesh shell = submesh(solid.mesh, triangles_of(solid.mesh, part));
    for (Triangle& t : shell.triangles) std::swap(t[1], t[2]);
    const Mesh blocker = grown(std::move(shell), growth);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), blocker.positions.begin(), blocker.positions.end());
    for (const Triangle& t : blocker.triangles)
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return mesh;
}

std::vector<ObjectPart> blocker_parts(const Solid& solid) {
  const std::size_t count = solid.mesh.triangles.size();
  ObjectPart blockers{kSupportBlockers, count, count - solid.outer_triangle_count(), false, ""};
  blockers.blocks_support = true;
  return {{"model", 0, count, false, ""}, blockers};
}

}  // namespace aerate
