#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/mesh.h"
#include "core/solid.h"
#include "kernels/vec.h"

namespace aerate {

// Where a page rounds places to: origin + step * whole numbers, mm.
struct PageGrid {
  Vec3d origin{0, 0, 0};
  double step = 1;
};

// No coarser than a quarter of the tolerance, and as fine as flat surfaces need to look flat. A tolerance of 0 asks for
// nothing; finer than fp32 resolves is of no use.
PageGrid page_grid(const Mesh& mesh, double tolerance);

// A mesh as a page reads it, part by part, in streams of bytes that deflate packs well (docs/view.md, "The format").
struct PageGeometry {
  std::string steps;    // one byte each: how the walk round what is known goes on
  std::string links;    // vertices that are met again otherwise than as a neighbour on the walk
  std::string x, y, z;  // of each vertex, how far it is from where it was expected, in steps of the grid
  std::size_t vertex_count = 0;  // those that parts share count once for each
};

// The same bytes for any number of threads.
PageGeometry encode_geometry(const Mesh& mesh, std::span<const SolidPart> parts, const PageGrid& grid);

}  // namespace aerate
