#pragma once

#include <algorithm>
#include <functional>
#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "kernels/vec.h"

namespace aerate::test {

// Signed distance in mm, or as near to it as matters at the surface; negative in the solid.
using Implicit = std::function<double(Vec3d)>;

inline Implicit ball(Vec3d centre, double radius) {
  return [=](Vec3d p) { return length(p - centre) - radius; };
}

// A round rod between two points, with flat ends.
inline Implicit rod(Vec3d a, Vec3d b, double radius) {
  return [=](Vec3d p) {
    const Vec3d axis = normalised(b - a);
    const double along = dot(p - a, axis);
    const double aside = length(p - a - axis * along);
    return std::max({aside - radius, -along, along - length(b - a)});
  };
}

inline Implicit both(Implicit a, Implicit b) {
  return [=](Vec3d p) { return std::min(a(p), b(p)); };
}
inline Implicit without(Implicit a, Implicit b) {
  return [=](Vec3d p) { return std::max(a(p), -b(p)); };
}

// The surface of what is solid within a cube of +-`reach` about the origin, meshed by OpenVDB.
inline Mesh mesh_of(const Implicit& solid, double reach, double voxel) {
  openvdb::initialize();
  const auto outside = static_cast<float>(3 * voxel);
  auto grid = openvdb::FloatGrid::create(outside);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  auto accessor = grid->getAccessor();
  const int most = static_cast<int>(reach / voxel);
  for (int x = -most; x <= most; ++x) {
    for (int y = -most; y <= most; ++y) {
      for (int z = -most; z <= most; ++z) {
        const double value = solid({x * voxel, y * voxel, z * voxel});
        accessor.setValue({x, y, z}, static_cast<float>(std::clamp(value, -3 * voxel, 3 * voxel)));
      }
    }
  }
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, points, quads);
  Mesh mesh;
  for (const openvdb::Vec3s& p : points) mesh.positions.push_back({p.x(), p.y(), p.z()});
  for (const openvdb::Vec4I& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  // Which way round depends on the version of OpenVDB.
  if (signed_volume(mesh) < 0) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  return mesh;
}

}  // namespace aerate::test
