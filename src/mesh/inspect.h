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

// One edge-connected component. A triangle with three equal corners belongs to none.
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
  // both directions although it is not open; non-manifold if it has more than two triangles. Triangles with a
  // repeated vertex do not count: they run along their edge once in each direction.
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

  // The next three are measured for a closed mesh some of whose shells may overlap (their boxes do, or one is
  // inside out), along 65,536 lines spread evenly over the model, the same in every run: good to about a
  // hundredth of the overlap. A single shell that runs through itself is not looked at.

  // Volume where the winding number is 2 or more, or negative; exactly 0 where parts only touch, or nest as
  // cavities do.
  double overlapped_volume = 0;
  // Volume where the winding number is not 0, which is what a slicer fills: `volume` without overlaps.
  double filled_volume = 0;
  std::size_t overlapping_shells =
      0;  // shells that bound such overlap: both of two boxes that run into each other

  // Parts overlap in more than a scan's stray folds do: the surface integral counts that volume twice, so
  // figures have to come from `filled_volume`. Below a hundred-thousandth of the volume the integral is the
  // better figure.
  bool parts_overlap() const { return overlapped_volume > 1e-5 * filled_volume; }
};

// O(m) expected in the triangles; the same result for any number of threads.
Inspection inspect(const Mesh& mesh);

// Pairs of triangles of a welded mesh that have points in common other than a vertex or edge that they share,
// found with CGAL (exact predicates); repeated triangles are such pairs, degenerate ones are left out. Slow:
// seconds for a million triangles.
struct SelfIntersections {
  std::size_t pair_count = 0;
  std::vector<Vec3d> places;  // centres of the first few pairs in triangle order, mm
};
SelfIntersections find_self_intersections(const Mesh& mesh);

}  // namespace aerate
