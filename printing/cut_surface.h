#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/segment_distance.h"

namespace aerate {

// A prism that starts inside a solid and ends outside.
struct CuttingPrism {
  std::vector<Vec3f> ring;  // where its lines start, counter-clockwise about the axis
  Vec3d axis;               // unit vector, outwards
  Vec3d start;              // on the axis, not beyond any point of the ring
  double length = 0;        // from there to its end
  double radius = 0;        // of a circle about the axis that holds the ring
};

// What a prism does to a surface. Indices count the mesh's vertices, then `new_positions`, then the ring.
struct SurfaceCut {
  std::vector<std::uint32_t> removed;  // triangles of the mesh that the prism meets, ascending
  std::vector<Vec3f> new_positions;    // where its lines and sides meet edges and triangles
  std::vector<Triangle> surface;       // what is left of the removed ones
  std::vector<Triangle> sides;         // the prism from its ring to the surface, facing the axis
};

// The triangles that a prism may meet are nearer to this axis than that (core/surface_index.h).
Segment axis_of(const CuttingPrism& prism);
double reach_of(const CuttingPrism& prism);

// Does the surface that a prism may meet, `near`, face its end all over, and is it 2-manifold? Quick; other
// reasons why it cannot be cut are rare.
bool may_be_cut(const Mesh& mesh, std::span<const std::uint32_t> near, const CuttingPrism& prism);

// Cuts a surface by a prism: CGAL's corefinement of the triangles that it may meet, `near`, ascending. Every
// other triangle stays as it is; it does not matter what flaws there are elsewhere. nullopt if the prism does
// not leave the solid through one piece of 2-manifold surface that faces its end all over, or if the new
// triangles would not be sound when they are rounded to fp32: projected along the axis, each of the surface
// has to have a positive area, so that they cover what they replace exactly once, and each of the sides has
// to face the axis.
std::optional<SurfaceCut> cut_surface(const Mesh& mesh, std::span<const std::uint32_t> near,
                                      const CuttingPrism& prism);

}  // namespace aerate
