#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh.h"
#include "core/segment_distance.h"
#include "kernels/triangle_bvh.h"

namespace aerate {

// Finds the triangles of a mesh near straight pieces, by a hierarchy of boxes that is built once.
class FacetsNear {
 public:
  // The mesh must outlive this and stay as it is.
  explicit FacetsNear(const Mesh& mesh);

  // Indices of the triangles nearer to the segment than `reach` mm, ascending.
  std::vector<std::uint32_t> find(const Segment& segment, double reach) const;

  const Mesh& mesh() const { return mesh_; }

 private:
  const Mesh& mesh_;
  kernels::HostTriangleBvh bvh_;
};

// The same by looking at every triangle: for a mesh that is asked once.
std::vector<std::uint32_t> facets_near(const Mesh& mesh, const Segment& segment, double reach);

}  // namespace aerate
