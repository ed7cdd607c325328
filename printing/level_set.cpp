#include "printing/level_set.h"

#include <cassert>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <vector>

namespace aerate {
namespace {

Mesh triangulate(const openvdb::FloatGrid& grid) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, quads);
  Mesh mesh;
  mesh.positions.reserve(points.size());
  for (const openvdb::Vec3s& p : points) mesh.positions.push_back({p.x(), p.y(), p.z()});
  // OpenVDB winds its quads clockwise seen from outside.
  mesh.triangles.reserve(2 * quads.size());
  for (const openvdb::Vec4I& q : quads) {
    mesh.triangles.push_back({q[0], q[2], q[1]});
    mesh.triangles.push_back({q[0], q[3], q[2]});
  }
  return mesh;
}

}  // namespace

Mesh mesh_level_set_of_ball(Vec3d centre, double radius) {
  assert(radius > kSmallestBallRadiusVoxels);
  const openvdb::Vec3f where(static_cast<float>(centre.x), static_cast<float>(centre.y),
                             static_cast<float>(centre.z));
  const auto grid =
      openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(static_cast<float>(radius), where, 1.0f);
  return triangulate(*grid);
}

}  // namespace aerate
