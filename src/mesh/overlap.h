#pragma once

#include <cstddef>
#include <vector>

#include "core/mesh.h"
#include "mesh/topology.h"

namespace aerate {

// Where parts of a closed mesh overlap, measured along a fixed set of lines along z: evenly spread, the same
// for every mesh but for the size of its box.
struct Overlap {
  double volume = 0;         // where the winding number is neither 0 nor 1, mm3
  double filled_excess = 0;  // volume where the winding number is not 0, less the signed volume, mm3
  std::size_t shells = 0;    // shells that bound such volume
};

// Exactly 0 where parts only touch or nest as cavities do. Deterministic.
Overlap measure_overlap(const Mesh& mesh, const ShellLabels& labels);

}  // namespace aerate
