#pragma once

#include "check/expected.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "packing/verify.h"

namespace aerate {

// Voids that fill cells, as they were written.
struct MeasuredCells {
  VolumeMoments inside;   // of all voids, if they are sealed
  Clearances clearances;  // lower bounds; of the wall no more than a tolerance beyond its limit is looked for
  double deviation = 0;   // of a surface from what it was before triangles were taken out, at most, mm
};

// Checks the voids of `expected.cells` in a mesh that was read back. Each is a closed, oriented 2-manifold that
// faces into it, with vertices of its own and of the Euler characteristic that was counted on the lattice; it runs
// through no other surface nor itself; no vertex passes a plane of its cell, so by convexity no triangle does; no
// triangle comes nearer to the model's surface than the wall, by exact distances; it lies where the winding number
// is 1; different voids keep the gap, told by the plane between two cells' spheres, or by the distances of their
// triangles where that does not tell; and its volume is the planned one to within the tolerance all over. Of voids that
// drain, which are one surface with their tubes, only places and distances are looked at (check_drained.h has the
// rest). O(n log n), on all threads. Throws FailureError for what is not so; InterruptedError.
MeasuredCells check_cells(const Mesh& read_back, const Expected& expected, Monitor& monitor);

}  // namespace aerate
