#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh.h"

namespace aerate {

// A closed chain of boundary edges: the rim of a hole.
struct BoundaryLoop {
  std::size_t edge_count = 0;
  Vec3d centre{0, 0, 0};  // mean of its vertices, mm
  double diameter = 0;    // diagonal of its bounding box, mm
};

// One edge-connected component.
struct Shell {
  std::size_t triangle_count = 0;
  double volume = 0;  // signed, mm3: negative for an inward shell (a cavity)
  Box3f box{};
  bool closed = true;
};

// What is right and wrong with a mesh. Facts only: nothing here is an error by itself.
struct Inspection {
  std::size_t vertex_count = 0;
  std::size_t triangle_count = 0;
  Box3f box{};
  double volume = 0;  // signed, mm3
  double area = 0;    // mm2

  // An edge is open if it has one triangle; misoriented if its triangles do not run along it equally often in
  // both directions although it is not open; non-manifold if it has more than two triangles.
  std::size_t open_edges = 0;
  std::size_t misoriented_edges = 0;
  std::size_t non_manifold_edges = 0;
  std::size_t degenerate_triangles = 0;      // zero area or repeated vertex
  std::size_t duplicate_triangles = 0;       // same three vertices in the same cyclic order as an earlier one
  std::vector<BoundaryLoop> boundary_loops;  // the largest first
  std::vector<Shell> shells;                 // the largest (by |volume|) first

  // Closed: every edge is run along equally often in both directions, so that the winding number is an
  // integer everywhere. Doubled edges do not make a mesh open.
  bool closed() const { return open_edges == 0 && misoriented_edges == 0; }

  // Volume where the winding number is 2 or more, or negative, estimated along a fixed raster of rays; 0 for
  // a model of one shell (unless it is inside out).
  double overlapped_volume = 0;
  // Volume where the winding number is not 0, which is what a slicer fills: `volume` for a model without
  // overlaps, otherwise estimated along the same rays.
  double filled_volume = 0;
  std::size_t overlapping_shells = 0;  // shells some of whose triangles lie inside another shell
};

// O(m log m) in the triangles.
Inspection inspect(const Mesh& mesh);

// Number of pairs of triangles that intersect other than along shared edges or vertices, found with CGAL
// (exact predicates). Degenerate triangles are left out. Slow: seconds for a million triangles.
struct SelfIntersections {
  std::size_t pair_count = 0;
  std::vector<Vec3d> places;  // centre of the first few pairs, mm
};
SelfIntersections find_self_intersections(const Mesh& mesh);

}  // namespace aerate
