#include "view/scene_rays.h"

#include <cstddef>

#include "kernels/constants.h"
#include "kernels/winding.h"

namespace aerate {
namespace {

// For the walk of a hierarchy: the least depth at (x, y) from `start` on.
struct DepthMetric {
  double x, y, start;
  const kernels::View<const kernels::Facet>& facets;
  double depth = kInfinity;
  std::uint32_t facet = kNone;

  double bound(const Box3f& box) const {
    const Vec3d lower = to_double(box.lower), upper = to_double(box.upper);
    const bool is_met = x >= lower.x && x <= upper.x && y >= lower.y && y <= upper.y && upper.z >= start;
    return is_met ? max_of(lower.z, start) : kInfinity;
  }
  double limit() const { return depth; }

  void visit(std::uint32_t i) {
    const kernels::Facet& f = facets[i];
    if (kernels::winding_detail::line_crossing(f, x, y) == 0) return;
    const Vec3d a = to_double(f.a);
    const Vec3d normal = cross(to_double(f.b) - a, to_double(f.c) - a);
    if (normal.z == 0) return;
    const double at = a.z - (normal.x * (x - a.x) + normal.y * (y - a.y)) / normal.z;
    if (at < start || !(at < depth)) return;
    depth = at;
    facet = i;
  }
};

}  // namespace

SceneRays::SceneRays(const Mesh& mesh, const std::vector<Vec3d>& corners)
    : behind_(behind_plane(mesh, corners)), bvh_(behind_.positions, behind_.triangles) {}

SceneRays::Behind SceneRays::behind_plane(const Mesh& mesh, const std::vector<Vec3d>& corners) {
  Behind behind;
  if (!corners.empty()) behind.origin = corners.front();
  behind.positions.reserve(corners.size());
  for (const Vec3d& corner : corners) behind.positions.push_back(to_float(corner - behind.origin));
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    if (corners[t[0]].z < 0 && corners[t[1]].z < 0 && corners[t[2]].z < 0) continue;
    behind.triangles.push_back(t);
    behind.of_mesh.push_back(i);
  }
  return behind;
}

std::optional<RayHit> SceneRays::first(double x, double y) const {
  if (behind_.triangles.empty()) return std::nullopt;
  const kernels::TriangleBvhView& bvh = bvh_.view();
  DepthMetric metric{x - behind_.origin.x, y - behind_.origin.y, -behind_.origin.z, bvh.facets};
  bvh.walk(metric);
  if (metric.facet == kNone) return std::nullopt;
  return RayHit{metric.depth + behind_.origin.z, behind_.of_mesh[bvh.order[metric.facet]]};
}

}  // namespace aerate
