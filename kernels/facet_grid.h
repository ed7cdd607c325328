#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/cell_grid.h"
#include "kernels/cell_references.h"
#include "kernels/facet.h"
#include "kernels/point_triangle.h"
#include "kernels/projected_triangle.h"
#include "kernels/vec.h"
#include "kernels/view.h"

// The indexed uniform grid of Cuba and Loaiza's method: which facets meet which cell. Theirs is a dense
// matrix of cells x facets; here it is CSR (4 bytes a cell and 4 a reference), beside a summed-volume table
// (4 bytes a cell) that tells in eight look-ups whether a box of cells holds any facet at all.

namespace aerate::kernels {

// What a kernel needs to ask about distances to facets.
struct FacetGridView {
  CellGrid grid;
  View<const Facet> facets;
  View<const std::uint32_t> offsets;     // cells + 1
  View<const std::uint32_t> references;  // facet indices, cell by cell
  View<const std::uint32_t> summed;      // references in all cells with no larger x, y and z, modulo 2^32

  AERATE_HD std::uint32_t summed_below(std::uint32_t x_end, std::uint32_t y_end, std::uint32_t z_end) const {
    if (x_end == 0 || y_end == 0 || z_end == 0) return 0;
    return summed[grid.index(x_end - 1, y_end - 1, z_end - 1)];
  }

  AERATE_HD bool is_empty(const CellBox& box) const {
    const std::uint32_t x1 = box.x1 + 1, y1 = box.y1 + 1, z1 = box.z1 + 1;
    return summed_below(x1, y1, z1) - summed_below(box.x0, y1, z1) - summed_below(x1, box.y0, z1) -
               summed_below(x1, y1, box.z0) + summed_below(box.x0, box.y0, z1) +
               summed_below(box.x0, y1, box.z0) + summed_below(x1, box.y0, box.z0) -
               summed_below(box.x0, box.y0, box.z0) ==
           0;
  }

  AERATE_HD bool any_nearer(Vec3d p, double distance_squared, std::uint32_t begin, std::uint32_t end) const {
    for (std::uint32_t i = begin; i < end; ++i) {
      if (is_facet_nearer(p, facets[references[i]], distance_squared)) return true;
    }
    return false;
  }

  // Distance along one axis from a coordinate to a cell; 0 inside it.
  AERATE_HD double axis_distance(double coordinate, double origin, std::uint32_t cell) const {
    const double lower = origin + static_cast<double>(cell) * grid.cell_size;
    const double upper = lower + grid.cell_size;
    return max_of(max_of(lower - coordinate, coordinate - upper), 0.0);
  }

  // Is any facet nearer to p than `distance` mm?
  AERATE_HD bool any_facet_within(Vec3d p, double distance) const {
    const Vec3d reach{distance, distance, distance};
    const CellBox box(grid, p - reach, p + reach);
    if (is_empty(box)) return false;
    const double distance_squared = distance * distance;
    // Most spheres that are too near are found out in the centre's own cell.
    const std::size_t own = grid.index_at(p);
    if (any_nearer(p, distance_squared, offsets[own], offsets[own + 1])) return true;
    // A little more than the distance, since cell bounds are rounded.
    const double reach_squared = distance_squared * (1 + 1e-9);
    for (std::uint32_t z = box.z0; z <= box.z1; ++z) {
      const double dz = axis_distance(p.z, grid.origin.z, z);
      for (std::uint32_t y = box.y0; y <= box.y1; ++y) {
        const double dy = axis_distance(p.y, grid.origin.y, y);
        const double left = reach_squared - dz * dz - dy * dy;
        if (left < 0) continue;
        // References of neighbouring cells in x are consecutive: one run for the whole row.
        const double half_width = std::sqrt(left);
        const std::size_t row = grid.index(0, y, z);
        if (any_nearer(p, distance_squared, offsets[row + grid.cell_x(p.x - half_width)],
                       offsets[row + grid.cell_x(p.x + half_width) + 1])) {
          return true;
        }
      }
    }
    return false;
  }
};

// The cells a facet is entered in: those it meets, by separating axes (the paper's test: the box's faces, the
// facet's plane, and the nine pairs of edges as three projections).
template <typename Visit>
AERATE_HD void for_each_cell(const CellGrid& grid, const Facet& facet, Visit visit) {
  const Vec3d a = to_double(facet.a);
  const Vec3d b = to_double(facet.b);
  const Vec3d c = to_double(facet.c);
  const CellBox box(grid, min_of(a, min_of(b, c)), max_of(a, max_of(b, c)));
  const std::size_t cells =
      static_cast<std::size_t>(box.x1 - box.x0 + 1) * (box.y1 - box.y0 + 1) * (box.z1 - box.z0 + 1);
  const Vec3d normal = cross(b - a, c - a);
  const Vec3d steepness{normal.x < 0 ? -normal.x : normal.x, normal.y < 0 ? -normal.y : normal.y,
                        normal.z < 0 ? -normal.z : normal.z};
  // Half a cell's extent along the normal, a little widened: cells are entered too often rather than too
  // seldom.
  const double plane_reach = 0.5 * grid.cell_size * (steepness.x + steepness.y + steepness.z) * (1 + 1e-6);
  const ProjectedTriangle xy{{a.x, a.y}, {b.x, b.y}, {c.x, c.y}};
  const ProjectedTriangle yz{{a.y, a.z}, {b.y, b.z}, {c.y, c.z}};
  const ProjectedTriangle zx{{a.z, a.x}, {b.z, b.x}, {c.z, c.x}};
  const double half = grid.cell_size / 2;
  for (std::uint32_t z = box.z0; z <= box.z1; ++z) {
    for (std::uint32_t y = box.y0; y <= box.y1; ++y) {
      for (std::uint32_t x = box.x0; x <= box.x1; ++x) {
        // Facets of a few cells are not worth the test, which only saves references.
        if (cells > 2) {
          const Vec3d centre = grid.origin + Vec3d{(static_cast<double>(x) + 0.5) * grid.cell_size,
                                                   (static_cast<double>(y) + 0.5) * grid.cell_size,
                                                   (static_cast<double>(z) + 0.5) * grid.cell_size};
          const double height = dot(normal, centre - a);
          if (height > plane_reach || height < -plane_reach) continue;
          if (cells > 8 &&
              !(xy.meets_square(centre.x, centre.y, half) && yz.meets_square(centre.y, centre.z, half) &&
                zx.meets_square(centre.z, centre.x, half))) {
            continue;
          }
        }
        visit(grid.index(x, y, z));
      }
    }
  }
}

namespace grid_detail {

// References up to and with a cell in its row along x, which the offsets tell.
struct SumAlongRow {
  View<const std::uint32_t> offsets;
  std::size_t row_length;
  View<std::uint32_t> sums;

  AERATE_HD void operator()(std::size_t i) const {
    sums[i] = offsets[i + 1] - offsets[i / row_length * row_length];
  }
};

// Running sums along one axis; an index is a line of cells.
struct SumAlongLine {
  View<std::uint32_t> values;
  std::size_t lines_per_block, block_stride, line_stride, step, steps;

  AERATE_HD void operator()(std::size_t line) const {
    const std::size_t first = line / lines_per_block * block_stride + line % lines_per_block * line_stride;
    std::uint32_t sum = 0;
    for (std::size_t k = 0; k < steps; ++k) {
      sum += values[first + k * step];
      values[first + k * step] = sum;
    }
  }
};

}  // namespace grid_detail

template <typename Executor>
struct FacetGrid {
  CellReferences<Executor> cells;
  typename Executor::template Buffer<std::uint32_t> summed;
  FacetGridView view;

  std::size_t bytes() const { return cells.bytes() + summed.size() * sizeof(std::uint32_t); }
};

// Enters the facets, which must stay alive beside the index. O(facets + cells + references).
// Throws std::length_error for more than 2^32 - 1 references.
template <typename Executor>
FacetGrid<Executor> build_facet_grid(const Executor& executor, View<const Facet> facets,
                                     const CellGrid& grid) {
  const std::size_t cells = grid.cell_count();
  FacetGrid<Executor> index;
  index.summed = executor.template allocate<std::uint32_t>(cells + 1);
  const View<std::uint32_t> sums = index.summed.view();
  index.cells = list_references(executor, facets, grid, sums);
  const View<const std::uint32_t> offsets = index.cells.offsets.view();

  const std::size_t nx = grid.count_x, ny = grid.count_y, nz = grid.count_z;
  executor.for_each_index(cells, grid_detail::SumAlongRow{offsets, nx, sums});
  executor.for_each_index(nx * nz, grid_detail::SumAlongLine{sums, nx, nx * ny, 1, nx, ny});
  executor.for_each_index(nx * ny, grid_detail::SumAlongLine{sums, nx * ny, 0, 1, nx * ny, nz});

  index.view = {grid, facets, offsets, index.cells.references.view(), sums};
  return index;
}

}  // namespace aerate::kernels
