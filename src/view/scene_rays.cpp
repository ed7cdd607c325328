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

// The same along any ray: whether there is a facet at all.
struct BlockedMetric {
  Vec3d from, direction;
  const kernels::View<const kernels::Facet>& facets;
  bool is_blocked = false;

  double bound(const Box3f& box) const {
    double first = 0, last = kInfinity;
    const auto narrow = [&](double start, double step, double low, double high) {
      if (step == 0) {
        if (start < low || start > high) last = -1;
        return;
      }
      const double a = (low - start) / step, b = (high - start) / step;
      first = max_of(first, min_of(a, b));
      last = min_of(last, max_of(a, b));
    };
    const Vec3d lower = to_double(box.lower), upper = to_double(box.upper);
    narrow(from.x, direction.x, lower.x, upper.x);
    narrow(from.y, direction.y, lower.y, upper.y);
    narrow(from.z, direction.z, lower.z, upper.z);
    if (first > last) return kInfinity;
    return first;
  }
  double limit() const { return is_blocked ? -1.0 : kInfinity; }

  // After T. Moeller and B. Trumbore, "Fast, minimum storage ray/triangle intersection", 1997.
  void visit(std::uint32_t i) {
    const Vec3d a = to_double(facets[i].a);
    const Vec3d u = to_double(facets[i].b) - a, v = to_double(facets[i].c) - a;
    const Vec3d across = cross(direction, v);
    const double determinant = dot(u, across);
    if (determinant == 0) return;
    const Vec3d offset = from - a;
    const double along_u = dot(offset, across) / determinant;
    const Vec3d other = cross(offset, u);
    const double along_v = dot(direction, other) / determinant;
    if (along_u < 0 || along_v < 0 || along_u + along_v > 1) return;
    if (dot(v, other) / determinant > 0) is_blocked = true;
  }
};

}  // namespace

bool LineOfSight::is_free(Vec3d from, Vec3d direction) const {
  const kernels::TriangleBvhView& bvh = bvh_.view();
  BlockedMetric metric{from, direction, bvh.facets};
  bvh.walk(metric);
  return !metric.is_blocked;
}

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
