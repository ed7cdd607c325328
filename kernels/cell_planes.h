#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/vec.h"

namespace aerate {

// One face of a cell: inside is dot(normal, x) <= offset. Unit normal, away from the cell; offset in mm.
struct CellPlane {
  Vec3d normal;
  double offset;
  std::uint32_t neighbour;
};

// Cells as planes, cell by cell (CSR). A cell is what its planes leave of the box that it was cut by.
struct CellPlanes {
  std::vector<std::uint32_t> first;  // cells + 1
  std::vector<CellPlane> planes;     // of a cell ascending by neighbour
  std::vector<Box3d> boxes;          // hold each cell, before its faces are moved in; cut by the box

  std::size_t size() const { return boxes.size(); }
  std::span<const CellPlane> of(std::size_t cell) const {
    return std::span(planes).subspan(first[cell], first[cell + 1] - first[cell]);
  }
};

}  // namespace aerate
