#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/mesh.h"

// Small exact meshes for tests.
namespace aerate::test {

// Twelve triangles, outward.
inline Mesh make_box(Vec3f lower, Vec3f upper) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.push_back({(corner & 1) != 0 ? upper.x : lower.x, (corner & 2) != 0 ? upper.y : lower.y,
                              (corner & 4) != 0 ? upper.z : lower.z});
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// All triangles of `a`, then all of `b`; vertices are not joined.
inline Mesh join(const Mesh& a, const Mesh& b) {
  Mesh mesh = a;
  const auto offset = static_cast<std::uint32_t>(a.positions.size());
  mesh.positions.insert(mesh.positions.end(), b.positions.begin(), b.positions.end());
  for (const Triangle& t : b.triangles)
    mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return mesh;
}

inline Mesh moved(Mesh mesh, Vec3f by) {
  for (Vec3f& p : mesh.positions) p = p + by;
  return mesh;
}

// A torus about the z axis; `rings` x `sides` quads, each two triangles, outward.
inline Mesh make_torus(double ring_radius, double tube_radius, std::uint32_t rings, std::uint32_t sides) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < rings; ++i) {
    const double u = 2 * std::numbers::pi * i / rings;
    for (std::uint32_t j = 0; j < sides; ++j) {
      const double v = 2 * std::numbers::pi * j / sides;
      const double distance = ring_radius + tube_radius * std::cos(v);
      mesh.positions.push_back(
          to_float({distance * std::cos(u), distance * std::sin(u), tube_radius * std::sin(v)}));
    }
  }
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t j = 0; j < sides; ++j) {
      const std::uint32_t next_i = (i + 1) % rings;
      const std::uint32_t next_j = (j + 1) % sides;
      const std::uint32_t a = i * sides + j, b = next_i * sides + j;
      const std::uint32_t c = next_i * sides + next_j, d = i * sides + next_j;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

// A sphere about the origin; `rings` x `sides` quads between the poles, outward.
inline Mesh make_uv_sphere(double radius, std::uint32_t rings, std::uint32_t sides) {
  Mesh mesh;
  const auto add = [&](double polar, double azimuth) {
    mesh.positions.push_back(
        to_float({radius * std::sin(polar) * std::cos(azimuth), radius * std::sin(polar) * std::sin(azimuth),
                  radius * std::cos(polar)}));
  };
  add(0, 0);
  for (std::uint32_t i = 1; i < rings; ++i) {
    for (std::uint32_t j = 0; j < sides; ++j)
      add(std::numbers::pi * i / rings, 2 * std::numbers::pi * j / sides);
  }
  add(std::numbers::pi, 0);
  const auto bottom = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  const auto at = [&](std::uint32_t ring, std::uint32_t side) {
    return 1 + (ring - 1) * sides + side % sides;
  };
  for (std::uint32_t j = 0; j < sides; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
    mesh.triangles.push_back({bottom, at(rings - 1, j + 1), at(rings - 1, j)});
  }
  return mesh;
}

inline Mesh turned_inside_out(Mesh mesh) {
  for (Triangle& t : mesh.triangles) t = {t[0], t[2], t[1]};
  return mesh;
}

}  // namespace aerate::test
