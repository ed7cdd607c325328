#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "kernels/adaptive_field.h"
#include "kernels/flagged.h"
#include "kernels/growing_buffer.h"
#include "kernels/paced.h"
#include "kernels/vec.h"
#include "kernels/view.h"

// The tree of cubes by which the adaptive packing finds where the clearance f is large without a dense grid.

namespace aerate::kernels {

// Cubes that still may hold the centre of a ball, largest at first, halved where f is of interest.
struct Cell {
  Vec3d centre;
  double surface;       // signed distance of the centre to the surface
  std::uint32_t facet;  // nearest to the centre
  std::uint32_t level;  // half diagonal = root_half_diagonal / 2^level

  AERATE_HD SurfaceAnchor anchor() const { return {centre, surface, facet}; }
};

struct CellsView {
  View<Cell> cells;
  View<double> bounds;  // f in the cell is at most this; -1 once the cell is dead
  double root_half_diagonal = 0;

  AERATE_HD double half_diagonal(std::size_t i) const {
    return root_half_diagonal / static_cast<double>(std::uint64_t{1} << cells[i].level);
  }
};

namespace cell_tree_detail {

constexpr double kHalfDiagonalOfEdge = 0.86602540378443865;  // sqrt(3)/2

struct FlagReaching {
  View<const double> bounds;
  double threshold;
  View<std::uint32_t> flags;

  AERATE_HD void operator()(std::size_t i) const { flags[i] = bounds[i] >= threshold ? 1 : 0; }
};

// Brings a cell's bound up to date with the balls placed since; says whether it is to be split.
struct Examine {
  CellsView cells;
  FieldView field;
  View<const std::uint32_t> active;
  double threshold;
  double finest;  // cells of at most this half diagonal are not split
  double most;
  View<std::uint32_t> split;   // 1 for cells to split
  View<std::uint32_t> search;  // 1 for cells to search

  AERATE_HD void operator()(std::size_t i) const {
    const std::uint32_t id = active[i];
    const Cell cell = cells.cells[id];
    const double half_diagonal = cells.half_diagonal(id);
    const double bound =
        min_of(cell.surface - field.wall, field.balls.nearest(cell.centre, most).clearance) + half_diagonal;
    split[i] = 0;
    search[i] = 0;
    if (bound < threshold) {
      cells.bounds[id] = bound;
    } else if (half_diagonal > finest) {
      split[i] = 1;
      cells.bounds[id] = -1;
    } else {
      search[i] = 1;
    }
  }
};

struct Child {
  Cell cell;
  double bound;
};

struct MakeChildren {
  CellsView cells;
  FieldView field;
  View<const std::uint32_t> parents;
  double least;  // children that cannot reach this are dropped
  double most;
  View<Child> children;  // 8 for each parent
  View<std::uint32_t> keep;

  AERATE_HD void operator()(std::size_t i) const {
    const std::uint32_t id = parents[i / 8];
    const Cell parent = cells.cells[id];
    const double half_diagonal = 0.5 * cells.half_diagonal(id);
    const double offset = half_diagonal / (2 * kHalfDiagonalOfEdge);
    const Vec3d centre =
        parent.centre + Vec3d{(i & 1) != 0 ? offset : -offset, (i & 2) != 0 ? offset : -offset,
                              (i & 4) != 0 ? offset : -offset};
    keep[i] = 0;
    const double by_balls = field.balls.nearest(centre, most).clearance;
    if (by_balls + half_diagonal < least) return;
    const SurfaceAnchor anchor = anchor_at(field, parent.anchor(), centre);
    const double by_surface = anchor.signed_distance - field.wall;
    if (by_surface + half_diagonal < least) return;
    children[i] = {{centre, anchor.signed_distance, anchor.facet, parent.level + 1},
                   min_of(by_balls, by_surface) + half_diagonal};
    keep[i] = 1;
  }
};

struct AppendChildren {
  View<const Child> children;
  View<const std::uint32_t> keep;
  View<const std::uint32_t> offsets;
  CellsView cells;
  std::size_t first;

  AERATE_HD void operator()(std::size_t i) const {
    if (keep[i] == 0) return;
    const std::size_t to = first + offsets[i];
    cells.cells[to] = children[i].cell;
    cells.bounds[to] = children[i].bound;
  }
};

struct MakeRoots {
  CellsView cells;
  FieldView field;
  Vec3d origin;
  double edge;
  std::uint32_t count_x, count_y;

  AERATE_HD void operator()(std::size_t i) const {
    const std::size_t column = i % count_x, row = i / count_x % count_y, layer = i / count_x / count_y;
    const auto x = static_cast<double>(column);
    const auto y = static_cast<double>(row);
    const auto z = static_cast<double>(layer);
    const Vec3d centre = origin + Vec3d{x + 0.5, y + 0.5, z + 0.5} * edge;
    const SurfaceAnchor anchor = anchor_at(field, {centre, 0, kNoFacet}, centre);
    cells.cells[i] = {centre, anchor.signed_distance, anchor.facet, 0};
    cells.bounds[i] = anchor.signed_distance - field.wall + cells.root_half_diagonal;
  }
};

}  // namespace cell_tree_detail

template <typename Executor>
class CellTree {
 public:
  CellTree(const Executor& executor, Paced<Executor>& paced) : executor_(executor), paced_(paced) {}

  CellsView view() { return {cells_.view(), bounds_.view(), root_half_diagonal_}; }

  // Covers the box; nothing is placed yet.
  void make_roots(const FieldView& field, const Box3d& box) {
    constexpr double kRootsAlongLongest = 12;
    const Vec3d size = box.upper - box.lower;
    const double edge = max_of(size.x, max_of(size.y, size.z)) / kRootsAlongLongest;
    const auto count = [&](double length) {
      return static_cast<std::uint32_t>(max_of(1.0, std::ceil(length / edge)));
    };
    const std::uint32_t nx = count(size.x), ny = count(size.y), nz = count(size.z);
    root_half_diagonal_ = edge * cell_tree_detail::kHalfDiagonalOfEdge;
    resize(std::size_t{nx} * ny * nz);
    executor_.for_each_index(cells_.size(),
                             cell_tree_detail::MakeRoots{view(), field, box.lower, edge, nx, ny});
  }

  // Halves cells until those in which f may reach `threshold` have half diagonals of at most `finest`.
  // Returns these, valid until the next call. `least`: cells that cannot reach this are not made.
  View<const std::uint32_t> refine(const FieldView& field, double threshold, double finest, double least) {
    using namespace cell_tree_detail;
    const double most = field.balls.reach;
    while (true) {
      executor_.for_each_index(bounds_.size(), FlagReaching{bounds_.view(), threshold, flags_.view()});
      const std::size_t active = list_flagged(executor_, flags_.view(), offsets_.view(), active_);
      split_.resize(executor_, active);
      wanted_.resize(executor_, active);
      scan_.resize(executor_, active);
      paced_.for_each_index(active, Examine{view(), field, active_.view(), threshold, finest, most,
                                            split_.view(), wanted_.view()});
      const std::size_t parents = list_flagged(executor_, split_.view(), scan_.view(), picked_);
      if (parents == 0) {
        const std::size_t searched = list_flagged(executor_, wanted_.view(), scan_.view(), picked_);
        chosen_.resize(executor_, searched);
        executor_.for_each_index(searched, GatherIds{active_.view(), picked_.view(), chosen_.view()});
        return chosen_.view();
      }
      chosen_.resize(executor_, parents);
      executor_.for_each_index(parents, GatherIds{active_.view(), picked_.view(), chosen_.view()});
      split(field, least);
    }
  }

 private:
  void resize(std::size_t count) {
    cells_.resize(executor_, count);
    bounds_.resize(executor_, count);
    flags_.resize(executor_, count);
    offsets_.resize(executor_, count);
  }

  // Appends the children of the chosen cells.
  void split(const FieldView& field, double least) {
    using namespace cell_tree_detail;
    const std::size_t count = chosen_.size() * 8;
    children_.resize(executor_, count);
    keep_.resize(executor_, count);
    scan_.resize(executor_, count);
    paced_.for_each_index(count, MakeChildren{view(), field, chosen_.view(), least, field.balls.reach,
                                              children_.view(), keep_.view()});
    const std::size_t kept = executor_.exclusive_scan(keep_.view(), scan_.view());
    const std::size_t first = cells_.size();
    resize(first + kept);
    executor_.for_each_index(count,
                             AppendChildren{children_.view(), keep_.view(), scan_.view(), view(), first});
  }

  const Executor& executor_;
  Paced<Executor>& paced_;
  double root_half_diagonal_ = 0;
  GrowingBuffer<Executor, Cell> cells_;
  GrowingBuffer<Executor, double> bounds_;
  GrowingBuffer<Executor, std::uint32_t> flags_, offsets_, active_, split_, wanted_, scan_, picked_, chosen_,
      keep_;
  GrowingBuffer<Executor, cell_tree_detail::Child> children_;
};

}  // namespace aerate::kernels
