#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "core/solid.h"
#include "kernels/sphere.h"

// Brute-force checks of closed shells, as oracles for what makes them.
namespace aerate::test {

// The triangles of a part alone, with their own vertices renumbered from 0, in their order.
inline Mesh extract(const Mesh& mesh, const SolidPart& part) {
  Mesh shell;
  std::set<std::uint32_t> used;
  for (const Triangle& t : triangles_of(mesh, part)) used.insert(t.begin(), t.end());
  std::map<std::uint32_t, std::uint32_t> renumbered;
  for (const std::uint32_t v : used) {
    renumbered.emplace(v, static_cast<std::uint32_t>(shell.positions.size()));
    shell.positions.push_back(mesh.positions[v]);
  }
  for (const auto& [a, b, c] : triangles_of(mesh, part))
    shell.triangles.push_back({renumbered.at(a), renumbered.at(b), renumbered.at(c)});
  return shell;
}

// Every directed edge exactly once, with its opposite; every vertex used, surrounded by one fan of triangles.
inline bool is_closed_manifold(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> left_of;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = mesh.triangles[i][k], to = mesh.triangles[i][(k + 1) % 3];
      if (from >= mesh.positions.size() || from == to) return false;
      if (!left_of.insert({{from, to}, i}).second) return false;
    }
  }
  std::vector<std::uint32_t> degree(mesh.positions.size());
  for (const auto& [edge, triangle] : left_of) {
    if (!left_of.contains({edge.second, edge.first})) return false;
    ++degree[edge.first];
  }
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const auto first = left_of.lower_bound({v, 0});
    if (first == left_of.end() || first->first.first != v) return false;
    std::uint32_t turned = 0;
    std::uint32_t to = first->first.second;
    do {
      const Triangle& t = mesh.triangles[left_of.at({v, to})];
      const auto k = static_cast<std::size_t>(std::find(t.begin(), t.end(), v) - t.begin());
      to = t[(k + 2) % 3];
      ++turned;
    } while (to != first->first.second && turned <= degree[v]);
    if (turned != degree[v]) return false;
  }
  return true;
}

// 2 for a sphere, 0 for a torus.
inline long euler_characteristic(const Mesh& mesh) {
  return static_cast<long>(mesh.positions.size()) - static_cast<long>(mesh.triangles.size()) / 2;
}

// How far a surface lies from a sphere, mm; negative is inside. Sampled on every triangle: its corners, a
// grid of points, and the foot of the perpendicular from the centre where that is in the triangle.
struct Deviation {
  double lowest = 0, highest = 0;
};
inline Deviation deviation_from(const Mesh& shell, const Sphere& sphere) {
  constexpr int kSteps = 8;
  Deviation deviation{1e300, -1e300};
  const auto sample = [&](Vec3d p) {
    const double distance = length(p - sphere.centre) - sphere.radius;
    deviation.lowest = std::min(deviation.lowest, distance);
    deviation.highest = std::max(deviation.highest, distance);
  };
  for (const Triangle& t : shell.triangles) {
    const Vec3d a = to_double(shell.positions[t[0]]);
    const Vec3d u = to_double(shell.positions[t[1]]) - a, v = to_double(shell.positions[t[2]]) - a;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) sample(a + u * (i / double{kSteps}) + v * (j / double{kSteps}));
    }
    const Vec3d normal = cross(u, v);
    const double square = length_squared(normal);
    const Vec3d to_centre = sphere.centre - a;
    const double beta = dot(cross(to_centre, v), normal) / square;
    const double gamma = dot(cross(u, to_centre), normal) / square;
    if (beta >= 0 && gamma >= 0 && beta + gamma <= 1) sample(a + u * beta + v * gamma);
  }
  return deviation;
}

// True if every triangle has area and, seen from outside the shell, faces away from `centre`.
inline bool is_star_shaped(const Mesh& outward_shell, Vec3d centre) {
  return std::all_of(outward_shell.triangles.begin(), outward_shell.triangles.end(), [&](const Triangle& t) {
    const Vec3d a = to_double(outward_shell.positions[t[0]]) - centre;
    const Vec3d b = to_double(outward_shell.positions[t[1]]) - centre;
    const Vec3d c = to_double(outward_shell.positions[t[2]]) - centre;
    return dot(a, cross(b, c)) > 0;
  });
}

}  // namespace aerate::test
