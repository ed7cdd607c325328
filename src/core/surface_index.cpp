#include "core/surface_index.h"

#include <algorithm>

namespace aerate {
namespace {

struct Box {
  Vec3d lower, upper;

  bool meets(const Box3f& other) const {
    const Vec3d least = to_double(other.lower), most = to_double(other.upper);
    return least.x <= upper.x && least.y <= upper.y && least.z <= upper.z && most.x >= lower.x &&
           most.y >= lower.y && most.z >= lower.z;
  }
};

Box box_round(const Segment& segment, double reach) {
  const Vec3d margin{reach, reach, reach};
  return {min_of(segment.start, segment.end) - margin, max_of(segment.start, segment.end) + margin};
}

// Collects instead of measuring: a box counts as near or not.
struct Collector {
  const kernels::TriangleBvhView& view;
  const Segment& segment;
  double reach;
  Box box;
  std::vector<std::uint32_t> found;

  double bound(const Box3f& other) const { return box.meets(other) ? 0 : 1; }
  double limit() const { return 0.5; }
  void visit(std::uint32_t i) {
    const kernels::Facet& facet = view.facets[i];
    if (box.meets(kernels::box_of(facet)) && distance_to_facet(segment, facet) < reach)
      found.push_back(view.order[i]);
  }
};

}  // namespace

SurfaceIndex::SurfaceIndex(const Mesh& mesh)
    : bvh_(mesh.positions, mesh.triangles), winding_(bvh_.view().facets) {}

std::vector<std::uint32_t> SurfaceIndex::triangles_near(const Segment& segment, double reach) const {
  Collector collector{bvh(), segment, reach, box_round(segment, reach), {}};
  bvh().walk(collector);
  std::sort(collector.found.begin(), collector.found.end());
  return std::move(collector.found);
}

std::vector<std::uint32_t> triangles_near(const Mesh& mesh, const Segment& segment, double reach) {
  const Box box = box_round(segment, reach);
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const kernels::Facet facet = facet_of(mesh, mesh.triangles[i]);
    if (box.meets(kernels::box_of(facet)) && distance_to_facet(segment, facet) < reach) found.push_back(i);
  }
  return found;
}

}  // namespace aerate
