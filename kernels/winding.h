#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>

#include "kernels/cell_grid.h"
#include "kernels/cell_references.h"
#include "kernels/facet.h"
#include "kernels/projected_triangle.h"
#include "kernels/vec.h"
#include "kernels/view.h"

// Winding numbers of points, by a signed count of the facets that a ray in +z crosses. Facets are indexed by
// the cells of a grid in the xy plane (CSR), so that a query reads one cell, and meets each facet once.

namespace aerate::kernels {

namespace winding_detail {

// Which side of the line a -> b the point lies on, in the xy plane. Computed in one canonical direction for
// both triangles at an edge, so that rounding cannot let a ray slip between them or hit both.
AERATE_HD inline bool is_left_of(Vec3d a, Vec3d b, double x, double y) {
  const bool swapped = b.x < a.x || (b.x == a.x && b.y < a.y);
  const Vec3d low = swapped ? b : a;
  const Vec3d high = swapped ? a : b;
  const bool left = (high.x - low.x) * (y - low.y) - (high.y - low.y) * (x - low.x) >= 0;
  return left != swapped;
}

// +1 or -1 if the line through (x, y) along z, followed upwards, leaves or enters the solid through the
// facet, else 0: the winding number of the projected facet about the point. Edges are half-open in y, so that
// a vertex belongs to one of its edges only.
AERATE_HD inline int line_crossing(const Facet& facet, double x, double y) {
  const bool a_below = static_cast<double>(facet.a.y) <= y;
  const bool b_below = static_cast<double>(facet.b.y) <= y;
  const bool c_below = static_cast<double>(facet.c.y) <= y;
  if (a_below == b_below && b_below == c_below) return 0;
  // Two edges pass the point's height, one up and one down, and meet in the corner that is alone on its side.
  const bool a_alone = b_below == c_below, b_alone = a_below == c_below;
  const Vec3f apex = a_alone ? facet.a : b_alone ? facet.b : facet.c;
  const Vec3f next = a_alone ? facet.b : b_alone ? facet.c : facet.a;
  const Vec3f last = a_alone ? facet.c : b_alone ? facet.a : facet.b;
  // An edge upwards counts 1 if the point is left of it, one downwards -1 if it is not.
  return (is_left_of(to_double(last), to_double(apex), x, y) ? 1 : 0) +
         (is_left_of(to_double(apex), to_double(next), x, y) ? 0 : -1);
}

// The same for the ray from p in +z.
AERATE_HD inline int facet_crossing(const Facet& facet, Vec3d p) {
  const int sign = line_crossing(facet, p.x, p.y);
  if (sign == 0) return 0;
  if (p.z < static_cast<double>(min_of(facet.a.z, min_of(facet.b.z, facet.c.z)))) return sign;
  if (p.z > static_cast<double>(max_of(facet.a.z, max_of(facet.b.z, facet.c.z)))) return 0;
  const Vec3d a = to_double(facet.a);
  const Vec3d b = to_double(facet.b);
  const Vec3d c = to_double(facet.c);
  const double height_above = dot(cross(b - a, c - a), p - a);
  return (sign > 0 ? height_above < 0 : height_above > 0) ? sign : 0;
}

}  // namespace winding_detail

// Grid of columns along z. `axis_cell` is monotone, so a point that lies within a facet's bounds falls into
// one of the cells the facet was entered in.
struct ColumnGrid {
  double origin_x = 0, origin_y = 0;
  double cells_per_mm = 1;
  std::uint32_t count_x = 1, count_y = 1;

  AERATE_HD std::uint32_t cell_x(double x) const { return axis_cell(x - origin_x, cells_per_mm, count_x); }
  AERATE_HD std::uint32_t cell_y(double y) const { return axis_cell(y - origin_y, cells_per_mm, count_y); }
  AERATE_HD std::size_t cell(std::uint32_t x, std::uint32_t y) const {
    return static_cast<std::size_t>(y) * count_x + x;
  }
};

// What a kernel needs to ask for winding numbers.
struct WindingView {
  ColumnGrid grid;
  Box3d box{};  // of all facets
  View<const Facet> facets;
  View<const std::uint32_t> offsets;     // cells + 1
  View<const std::uint32_t> references;  // facet indices, cell by cell

  // 1 inside a plain solid, 0 outside; 2 where two parts overlap. Meaningful for a closed mesh. A point on
  // the surface gets the number of one side or the other.
  AERATE_HD int winding_number(Vec3d p) const {
    if (!(p.x >= box.lower.x && p.x <= box.upper.x && p.y >= box.lower.y && p.y <= box.upper.y &&
          p.z >= box.lower.z && p.z <= box.upper.z)) {
      return 0;
    }
    int winding = 0;
    for_each_near(p.x, p.y,
                  [&](std::uint32_t i) { winding += winding_detail::facet_crossing(facets[i], p); });
    return winding;
  }

  // Calls visit(index of facet) for the facets that the line through (x, y) along z may meet.
  template <typename Visit>
  AERATE_HD void for_each_near(double x, double y, Visit visit) const {
    const std::size_t cell = grid.cell(grid.cell_x(x), grid.cell_y(y));
    for (std::uint32_t i = offsets[cell]; i < offsets[cell + 1]; ++i) visit(references[i]);
  }
};

// The columns a facet is entered in: those that its projection along z meets. Long diagonal facets would fill
// the rectangle around them otherwise.
template <typename Visit>
AERATE_HD void for_each_cell(const ColumnGrid& grid, const Facet& facet, Visit visit) {
  const Vec3d a = to_double(facet.a);
  const Vec3d b = to_double(facet.b);
  const Vec3d c = to_double(facet.c);
  const Vec3d lower = min_of(a, min_of(b, c));
  const Vec3d upper = max_of(a, max_of(b, c));
  const std::uint32_t x0 = grid.cell_x(lower.x), x1 = grid.cell_x(upper.x);
  const std::uint32_t y0 = grid.cell_y(lower.y), y1 = grid.cell_y(upper.y);
  const bool is_long = (x1 - x0) * std::uint64_t{y1 - y0} > 2;
  const ProjectedTriangle projection{{a.x, a.y}, {b.x, b.y}, {c.x, c.y}};
  const double cell = 1.0 / grid.cells_per_mm;
  for (std::uint32_t y = y0; y <= y1; ++y) {
    for (std::uint32_t x = x0; x <= x1; ++x) {
      if (is_long &&
          !projection.meets_square(grid.origin_x + (static_cast<double>(x) + 0.5) * cell,
                                   grid.origin_y + (static_cast<double>(y) + 0.5) * cell, cell / 2)) {
        continue;
      }
      visit(grid.cell(x, y));
    }
  }
}

inline constexpr double kFacetsPerColumn = 6;

template <typename Executor>
struct WindingIndex {
  CellReferences<Executor> cells;
  WindingView view;
};

// Indexes facets, which must stay alive beside the index. References grow
// linearly with the facets as long as these are not much longer than wide. O(facets + cells).
//   box: outside it every winding number is 0
//   region: where points are going to be asked for; the facets above and below it must be there
// Throws std::length_error for more than 2^32 - 1 references.
template <typename Executor>
WindingIndex<Executor> build_winding_index(const Executor& executor, View<const Facet> facets,
                                           const Box3d& box, const Box3d& region) {
  ColumnGrid grid;
  grid.origin_x = region.lower.x;
  grid.origin_y = region.lower.y;
  const double width = max_of(region.upper.x - region.lower.x, 0.0);
  const double depth = max_of(region.upper.y - region.lower.y, 0.0);
  const double longest = max_of(width, depth);
  if (longest > 0) {
    // Columns somewhat wider than a facet: each facet is entered in two or three (bench: at one column for
    // each facet the index of 871,414 of them takes 8 times as long to build, and queries are no faster).
    const double wanted_cells = max_of(1.0, static_cast<double>(facets.size) / kFacetsPerColumn);
    // A narrow box is given its long side's resolution only, so that the number of cells stays bounded.
    const double cell = max_of(std::sqrt(width * depth / wanted_cells), longest / wanted_cells);
    grid.cells_per_mm = 1.0 / cell;
    grid.count_x = static_cast<std::uint32_t>(width / cell) + 1;
    grid.count_y = static_cast<std::uint32_t>(depth / cell) + 1;
  }
  const std::size_t cells = static_cast<std::size_t>(grid.count_x) * grid.count_y;
  auto counts = executor.template allocate<std::uint32_t>(cells + 1);
  WindingIndex<Executor> index;
  index.cells = list_references(executor, facets, grid, counts.view());
  index.view = {grid, box, facets, index.cells.offsets.view(), index.cells.references.view()};
  return index;
}

template <typename Executor>
WindingIndex<Executor> build_winding_index(const Executor& executor, View<const Facet> facets,
                                           const Box3d& box) {
  return build_winding_index(executor, facets, box, box);
}

// Box of facets in host memory; empty (lower > upper) without any.
Box3d bounding_box(View<const Facet> facets);

// Winding numbers with respect to one mesh, for host code.
class HostWinding {
 public:
  HostWinding(std::span<const Vec3f> positions, std::span<const std::array<std::uint32_t, 3>> triangles);
  // Of facets in host memory, which must outlive this.
  explicit HostWinding(View<const Facet> facets);
  ~HostWinding();
  HostWinding(HostWinding&&) noexcept;
  HostWinding& operator=(HostWinding&&) noexcept;

  // Valid while this object lives.
  const WindingView& view() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aerate::kernels
