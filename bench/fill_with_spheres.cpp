#include "bench/fill_with_spheres.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToSpheres.h>

namespace aerate::bench {

std::vector<Sphere> fill_with_spheres(const Mesh& mesh, std::size_t count, double voxel) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vec3f& p : mesh.positions) points.emplace_back(p.x, p.y, p.z);
  for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  const auto grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, triangles, 3.0f);

  std::vector<openvdb::Vec4s> filled;
  constexpr bool kOverlapping = false;
  constexpr float kLeastRadiusVoxels = 0.5f;
  constexpr float kIsovalue = 0.0f;
  constexpr int kInstances = 100000;
  openvdb::tools::fillWithSpheres(*grid, filled, openvdb::Vec2i(1, static_cast<int>(count)), kOverlapping,
                                  kLeastRadiusVoxels, std::numeric_limits<float>::max(), kIsovalue,
                                  kInstances);
  std::vector<Sphere> spheres;
  for (const openvdb::Vec4s& s : filled) {
    spheres.push_back({{double{s[0]}, double{s[1]}, double{s[2]}}, double{s[3]}, SphereKind::adaptive});
  }
  return spheres;
}

}  // namespace aerate::bench
