#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh.h"
#include "printing/cells/shared_work.h"

namespace aerate {

// A closed 2-manifold with fewer of its own vertices.
struct Decimated {
  std::vector<std::uint32_t> vertices;  // of the result: which of the positions they are, ascending
  std::vector<Triangle> triangles;      // indices into `vertices`
};

// Takes vertices out of a closed 2-manifold, by collapsing edges onto one of their ends, while no vertex that went
// is farther from the surface than `tolerance`, by the sum of the steps that it was left behind by. The cheapest
// edges first, by the mean squared distance of the vertex that stays from the planes of all triangles that went
// (M. Garland and P. Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997),
// in passes, no two beside each other in one pass. Orientation, topology (link
// condition: T. Dey et al., "Topology preserving edge contraction", 1999) and the shape of triangles are kept:
// none is turned by more than some 60 degrees or becomes a needle that it was not. The result depends on the
// arguments alone. O(n log n).
Decimated decimate(const std::vector<Vec3d>& positions, std::vector<Triangle> triangles, double tolerance,
                   SharedWork& work);

}  // namespace aerate
