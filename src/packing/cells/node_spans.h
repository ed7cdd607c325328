#pragma once

#include <vector>

#include "core/mesh.h"
#include "packing/cells/node_pools.h"

namespace aerate {

// The height that each node of a void stands for.
struct NodeSpans {
  // Below and above the node along up, mm: as far as the void's surface if that is within a spacing, else
  // half of one, up to the next node's share.
  std::vector<float> below, above;
};

// `surface`: of the void, facing into it. Where `up` is no axis of the lattice all spans are half a spacing.
// O(nodes + area of the surface in spacings).
NodeSpans spans_of(const VoidNodes& nodes, const Mesh& surface, Vec3d up);

}  // namespace aerate
