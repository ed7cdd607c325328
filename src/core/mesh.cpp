#include "core/mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace aerate {

Mesh submesh(const Mesh& mesh, std::span<const Triangle> triangles) {
  Mesh part;
  part.triangles.reserve(triangles.size());
  std::unordered_map<std::uint32_t, std::uint32_t> number_of;
  for (Triangle t : triangles) {
    for (std::uint32_t& vertex : t) {
      const auto next = static_cast<std::uint32_t>(part.positions.size());
      const auto [place, is_new] = number_of.try_emplace(vertex, next);
      if (is_new) part.positions.push_back(mesh.positions[vertex]);
      vertex = place->second;
    }
    part.triangles.push_back(t);
  }
  return part;
}

void drop_unused_vertices(Mesh& mesh) {
  std::vector<std::uint32_t> renumbered(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) renumbered[v] = 1;
  }
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (renumbered[v] == 0) continue;
    mesh.positions[count] = mesh.positions[v];
    renumbered[v] = count++;
  }
  mesh.positions.resize(count);
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) v = renumbered[v];
  }
}

Box3f bounding_box(const Mesh& mesh) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  Box3f box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      box.lower = min_of(box.lower, mesh.positions[vertex]);
      box.upper = max_of(box.upper, mesh.positions[vertex]);
    }
  }
  return box;
}

VolumeMoments volume_moments(const Mesh& mesh) {
  if (mesh.triangles.empty()) return {};
  // Tetrahedra from the box centre rather than from the origin: a model far from the origin keeps its digits.
  const Box3f box = bounding_box(mesh);
  return volume_moments(mesh, mesh.triangles, (to_double(box.lower) + to_double(box.upper)) * 0.5);
}

VolumeMoments volume_moments(const Mesh& mesh, std::span<const Triangle> triangles, Vec3d origin) {
  double volume_times_6 = 0;
  Vec3d moment_times_24{0, 0, 0};
  for (const Triangle& triangle : triangles) {
    const Vec3d a = to_double(mesh.positions[triangle[0]]) - origin;
    const Vec3d b = to_double(mesh.positions[triangle[1]]) - origin;
    const Vec3d c = to_double(mesh.positions[triangle[2]]) - origin;
    const double determinant = dot(a, cross(b, c));
    volume_times_6 += determinant;
    moment_times_24 = moment_times_24 + (a + b + c) * determinant;
  }
  VolumeMoments moments;
  moments.volume = volume_times_6 / 6.0;
  moments.first_moment = moment_times_24 * (1.0 / 24.0) + origin * moments.volume;
  return moments;
}

double largest_coordinate(const Mesh& mesh) {
  const Box3f box = bounding_box(mesh);
  double largest = 0;
  for (const Vec3d p : {to_double(box.lower), to_double(box.upper)})
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

double signed_volume(const Mesh& mesh) {
  return volume_moments(mesh).volume;
}

double surface_area(const Mesh& mesh) {
  double area_times_2 = 0;
  for (const Triangle& triangle : mesh.triangles) {
    const Vec3d a = to_double(mesh.positions[triangle[0]]);
    const Vec3d b = to_double(mesh.positions[triangle[1]]);
    const Vec3d c = to_double(mesh.positions[triangle[2]]);
    area_times_2 += length(cross(b - a, c - a));
  }
  return area_times_2 / 2.0;
}

}  // namespace aerate
