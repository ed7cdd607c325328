#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/segment_distance.h"
#include "kernels/triangle_bvh.h"
#include "kernels/winding.h"

namespace aerate {

// The triangles of a mesh, indexed once for all who ask where its surface is: a hierarchy of boxes for
// distances and for what is near, and columns for winding numbers. It holds a copy of the triangles, so the
// mesh need not outlive it.
class SurfaceIndex {
 public:
  explicit SurfaceIndex(const Mesh& mesh);

  // For use in the caller's own loops; valid while this object lives.
  const kernels::TriangleBvhView& bvh() const { return bvh_.view(); }
  const kernels::WindingView& winding() const { return winding_.view(); }

  // Exact (fp64) distance of each point to the surface, mm.
  std::vector<double> distances(std::span<const Vec3d> points) const { return bvh_.distances(points); }

  // Indices in the mesh of the triangles nearer to the segment than `reach` mm, ascending.
  std::vector<std::uint32_t> triangles_near(const Segment& segment, double reach) const;

 private:
  kernels::HostTriangleBvh bvh_;
  kernels::HostWinding winding_;  // of the hierarchy's facets
};

// The same by looking at every triangle: for a mesh that is asked once.
std::vector<std::uint32_t> triangles_near(const Mesh& mesh, const Segment& segment, double reach);

}  // namespace aerate
