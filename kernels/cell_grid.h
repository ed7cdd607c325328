#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/vec.h"

// Uniform grids of cubes, for indexes of facets, balls and candidates.

namespace aerate::kernels {

// The cell that a coordinate falls into, `distance` from where the cells begin; the first or the last one
// beyond them. Monotone: what lies between two coordinates lies between their cells.
AERATE_HD inline std::uint32_t axis_cell(double distance, double cells_per_mm, std::uint32_t count) {
  const double cell = distance * cells_per_mm;
  if (!(cell > 0)) return 0;
  return cell >= static_cast<double>(count) ? count - 1 : static_cast<std::uint32_t>(cell);
}

// Cells along x run fastest.
struct CellGrid {
  Vec3d origin{0, 0, 0};
  double cells_per_mm = 1;
  double cell_size = 1;  // mm
  std::uint32_t count_x = 1, count_y = 1, count_z = 1;

  AERATE_HD std::uint32_t cell_x(double x) const { return axis_cell(x - origin.x, cells_per_mm, count_x); }
  AERATE_HD std::uint32_t cell_y(double y) const { return axis_cell(y - origin.y, cells_per_mm, count_y); }
  AERATE_HD std::uint32_t cell_z(double z) const { return axis_cell(z - origin.z, cells_per_mm, count_z); }
  AERATE_HD std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (static_cast<std::size_t>(z) * count_y + y) * count_x + x;
  }
  AERATE_HD std::size_t index_at(Vec3d p) const { return index(cell_x(p.x), cell_y(p.y), cell_z(p.z)); }
  AERATE_HD std::size_t cell_count() const { return static_cast<std::size_t>(count_x) * count_y * count_z; }
};

// The grid over `box` with cells of `cell_size` mm.
inline CellGrid make_cell_grid(const Box3d& box, double cell_size) {
  CellGrid grid;
  grid.origin = box.lower;
  grid.cell_size = cell_size;
  grid.cells_per_mm = 1.0 / cell_size;
  const Vec3d extent = box.upper - box.lower;
  grid.count_x = static_cast<std::uint32_t>(extent.x * grid.cells_per_mm) + 1;
  grid.count_y = static_cast<std::uint32_t>(extent.y * grid.cells_per_mm) + 1;
  grid.count_z = static_cast<std::uint32_t>(extent.z * grid.cells_per_mm) + 1;
  return grid;
}

// A box of cells, bounds included.
struct CellBox {
  std::uint32_t x0, x1, y0, y1, z0, z1;

  AERATE_HD CellBox(std::uint32_t first_x, std::uint32_t last_x, std::uint32_t first_y, std::uint32_t last_y,
                    std::uint32_t first_z, std::uint32_t last_z)
      : x0(first_x), x1(last_x), y0(first_y), y1(last_y), z0(first_z), z1(last_z) {}
  AERATE_HD CellBox(const CellGrid& grid, Vec3d lower, Vec3d upper)
      : x0(grid.cell_x(lower.x)),
        x1(grid.cell_x(upper.x)),
        y0(grid.cell_y(lower.y)),
        y1(grid.cell_y(upper.y)),
        z0(grid.cell_z(lower.z)),
        z1(grid.cell_z(upper.z)) {}
};

}  // namespace aerate::kernels
