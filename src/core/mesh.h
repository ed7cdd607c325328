#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/facet.h"
#include "kernels/vec.h"

namespace aerate {

// Vertex indices of a triangle, counter-clockwise seen from outside the solid.
using Triangle = std::array<std::uint32_t, 3>;

// An indexed triangle mesh, the value every stage passes on.
//   positions: n x 3, millimetres, fp32 exactly as read (or as converted once from the file's unit)
//   triangles: m x 3, indices into positions
struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
};

// A triangle of the mesh with its corners at hand.
inline kernels::Facet facet_of(const Mesh& mesh, const Triangle& t) {
  return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
}

// Some triangles of the mesh with vertices of their own, in order of first use: those that shared one still do.
Mesh submesh(const Mesh& mesh, std::span<const Triangle> triangles);

// Takes vertices out that no triangle uses; the others keep their order.
void drop_unused_vertices(Mesh& mesh);

// Smallest box around the positions that triangles use; empty (lower > upper) for a mesh without triangles.
Box3f bounding_box(const Mesh& mesh);

// Of all corners' coordinates the largest without sign, mm: what fp32 resolves by.
double largest_coordinate(const Mesh& mesh);

// Signed volume in mm3 (divergence theorem, fp64, relative to the box centre): each triangle's contribution
// is summed in index order, so the result does not depend on threads. Positive for outward orientation.
double signed_volume(const Mesh& mesh);

// Surface area in mm2.
double surface_area(const Mesh& mesh);

// Volume, and the volume integral of position (mm4): centroid = first_moment / volume. Moments of several
// closed meshes add up.
struct VolumeMoments {
  double volume = 0;
  Vec3d first_moment{0, 0, 0};
};
VolumeMoments volume_moments(const Mesh& mesh);

// The same for some triangles of a mesh, as tetrahedra from `origin`: a sum over parts of a closed mesh gives
// the whole if all have the same origin.
VolumeMoments volume_moments(const Mesh& mesh, std::span<const Triangle> triangles, Vec3d origin);

}  // namespace aerate
