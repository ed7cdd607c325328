#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/mesh.h"
#include "kernels/triangle_bvh.h"
#include "kernels/vec.h"

namespace aerate {

// What is met first along z at a point of a view.
struct RayHit {
  double depth = 0;            // z, mm
  std::uint32_t triangle = 0;  // of the mesh
};

// The triangles of a mesh that reach behind the plane of a cut, indexed for rays from there on away from who looks.
class SceneRays {
 public:
  // `corners`: of the mesh, in view coordinates
  SceneRays(const Mesh& mesh, const std::vector<Vec3d>& corners);

  // The first triangle at a depth of at least 0. On all rays between those of two pixels of a closed surface there is one:
  // an edge belongs to one of its triangles (kernels/winding.h).
  std::optional<RayHit> first(double x, double y) const;

 private:
  struct Behind {
    std::vector<Vec3f> positions;
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> of_mesh;  // by triangle
    Vec3d origin{0, 0, 0};               // of the positions
  };
  static Behind behind_plane(const Mesh& mesh, const std::vector<Vec3d>& corners);

  Behind behind_;
  kernels::HostTriangleBvh bvh_;
};

// Whether anything of a mesh stands in the way, in the model's coordinates.
class LineOfSight {
 public:
  explicit LineOfSight(const Mesh& mesh) : bvh_(mesh.positions, mesh.triangles) {}
  bool is_free(Vec3d from, Vec3d direction) const;

 private:
  kernels::HostTriangleBvh bvh_;
};

}  // namespace aerate
