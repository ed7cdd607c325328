#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "kernels/atomic.h"
#include "kernels/constants.h"
#include "kernels/facet.h"
#include "kernels/view.h"

// Which facets each cell of a grid holds, cell by cell (CSR): the indexes of winding numbers and of
// distances. A grid says by `for_each_cell(grid, facet, visit)` which of its cells a facet is entered in.

namespace aerate::kernels {

namespace cell_references_detail {

template <typename Grid>
struct CountReferences {
  Grid grid;
  View<const Facet> facets;
  View<std::uint32_t> counts;

  AERATE_HD void operator()(std::size_t i) const {
    const View<std::uint32_t> cells = counts;
    for_each_cell(grid, facets[i], [cells](std::size_t cell) { atomic_add(cells[cell], 1); });
  }
};

// Fills each cell from its end towards its start. The order inside a cell depends on timing, which no query
// can see: it adds integers, or asks whether any facet is near.
template <typename Grid>
struct FillReferences {
  Grid grid;
  View<const Facet> facets;
  View<std::uint32_t> remaining;
  View<const std::uint32_t> offsets;
  View<std::uint32_t> references;

  AERATE_HD void operator()(std::size_t i) const {
    const FillReferences self = *this;
    for_each_cell(grid, facets[i], [self, i](std::size_t cell) {
      const std::uint32_t slot = atomic_add(self.remaining[cell], ~std::uint32_t{0}) - 1;
      self.references[self.offsets[cell] + slot] = static_cast<std::uint32_t>(i);
    });
  }
};

}  // namespace cell_references_detail

template <typename Executor>
struct CellReferences {
  typename Executor::template Buffer<std::uint32_t> offsets;     // cells + 1
  typename Executor::template Buffer<std::uint32_t> references;  // facet indices, cell by cell

  std::size_t bytes() const { return (offsets.size() + references.size()) * sizeof(std::uint32_t); }
};

// O(facets + cells + references).
//   counts: for work, a number for each cell and one more; means nothing afterwards
// Throws std::length_error for more than 2^32 - 1 references.
template <typename Executor, typename Grid>
CellReferences<Executor> list_references(const Executor& executor, View<const Facet> facets, const Grid& grid,
                                         View<std::uint32_t> counts) {
  using namespace cell_references_detail;
  executor.for_each_index(counts.size, SetAll<std::uint32_t>{counts, 0});
  executor.for_each_index(facets.size, CountReferences<Grid>{grid, facets, counts});
  CellReferences<Executor> cells;
  cells.offsets = executor.template allocate<std::uint32_t>(counts.size);
  const std::uint64_t total = executor.exclusive_scan(counts, cells.offsets.view());
  if (total > kNone) throw std::length_error("an index of facets has more than 2^32 - 1 references");
  cells.references = executor.template allocate<std::uint32_t>(total);
  executor.for_each_index(
      facets.size, FillReferences<Grid>{grid, facets, counts, cells.offsets.view(), cells.references.view()});
  return cells;
}

}  // namespace aerate::kernels
