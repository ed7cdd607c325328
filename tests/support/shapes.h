#pragma once

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

inline Mesh turned_inside_out(Mesh mesh) {
  for (Triangle& t : mesh.triangles) t = {t[0], t[2], t[1]};
  return mesh;
}

}  // namespace aerate::test
