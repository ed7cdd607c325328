#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "kernels/adaptive_field.h"
#include "kernels/growing_buffer.h"
#include "kernels/paced.h"
#include "kernels/tally.h"
#include "kernels/vec.h"
#include "kernels/view.h"

// The tree of cubes by which the adaptive packing finds where the clearance f is large without a dense grid.

namespace aerate::kernels {

// Cubes that still may hold the centre of a ball, largest at first, halved where f is of interest.
struct Cell {
  Vec3d centre;
  double surface;  // signed distance of the centre to the surface, or less where balls are nearer than that
  std::uint32_t facet;  // nearest to the centre, or not far from it
  std::uint32_t level;  // half diagonal = root_half_diagonal / 2^level

  AERATE_HD SurfaceAnchor anchor() const { return {centre, surface, facet}; }
};

AERATE_HD inline double half_diagonal_of(double root_half_diagonal, std::uint32_t level) {
  return root_half_diagonal / static_cast<double>(std::uint64_t{1} << level);
}

struct CellsView {
  View<Cell> cells;
  View<double> bounds;  // f in the cell is at most this; -1 once the cell is dead
  double root_half_diagonal = 0;

  AERATE_HD double half_diagonal(std::size_t i) const {
    return half_diagonal_of(root_half_diagonal, cells[i].level);
  }
};

namespace cell_tree_detail {

constexpr double kHalfDiagonalOfEdge = 0.86602540378443865;  // sqrt(3)/2

// What becomes of a cell or of a child that was made: nothing (not in the list, or asleep there), to be
// halved or to be searched.
enum class CellFate : std::uint8_t { dropped, asleep, halved, searched };

AERATE_HD inline CellFate fate_of(double bound, double half_diagonal, double threshold, double finest) {
  if (bound < threshold) return CellFate::asleep;
  return half_diagonal > finest ? CellFate::halved : CellFate::searched;
}

// Brings a cell's bound up to date with the balls placed since, if that decides its fate.
template <typename Shape>
struct Examine {
  CellsView cells;
  FieldView<Shape> field;
  std::size_t first;
  double threshold;
  double finest;  // cells of at most this half diagonal are not halved
  View<CellFate> fates;

  AERATE_HD void operator()(std::size_t i) const {
    const std::size_t id = first + i;
    fates[i] = CellFate::asleep;
    if (cells.bounds[id] < threshold) return;
    const Cell cell = cells.cells[id];
    const double half_diagonal = cells.half_diagonal(id);
    const double bound =
        min_of(cell.surface - field.wall, field.balls.nearest(cell.centre, field.balls.reach).clearance) +
        half_diagonal;
    fates[i] = fate_of(bound, half_diagonal, threshold, finest);
    if (fates[i] == CellFate::asleep) cells.bounds[id] = bound;
    if (fates[i] == CellFate::halved) cells.bounds[id] = -1;
  }
};

// First list: cells to halve; second: to search; third: those that still may be of use.
struct TallyCells {
  CellsView cells;
  View<const CellFate> fates;
  std::size_t first;
  double least;

  AERATE_HD Tally operator()(std::size_t i) const {
    return {fates[i] == CellFate::halved ? 1u : 0u, fates[i] == CellFate::searched ? 1u : 0u,
            cells.bounds[first + i] >= least ? 1u : 0u};
  }
};

struct ListCells {
  CellsView cells;
  View<const CellFate> fates;
  std::size_t first;
  View<Cell> parents;
  View<std::uint32_t> searched;

  AERATE_HD void operator()(std::size_t i, Tally before) const {
    if (fates[i] == CellFate::halved) parents[before.first] = cells.cells[first + i];
    if (fates[i] == CellFate::searched) searched[before.second] = static_cast<std::uint32_t>(first + i);
  }
};

struct Child {
  Cell cell;
  double bound;
};

template <typename Shape>
struct MakeChildren {
  FieldView<Shape> field;
  double root_half_diagonal;
  View<const Cell> parents;
  double threshold;
  double finest;
  double least;          // children that cannot reach this are dropped
  View<Child> children;  // 8 for each parent
  View<CellFate> fates;

  AERATE_HD void operator()(std::size_t i) const {
    const Cell parent = parents[i / 8];
    const double half_diagonal = 0.5 * half_diagonal_of(root_half_diagonal, parent.level);
    const double offset = half_diagonal / (2 * kHalfDiagonalOfEdge);
    const Vec3d centre =
        parent.centre + Vec3d{(i & 1) != 0 ? offset : -offset, (i & 2) != 0 ? offset : -offset,
                              (i & 4) != 0 ? offset : -offset};
    fates[i] = CellFate::dropped;
    const double by_balls = field.balls.nearest(centre, field.balls.reach).clearance;
    if (by_balls + half_diagonal < least) return;
    const SurfaceAnchor anchor = anchor_within(field, parent.anchor(), centre, by_balls + field.wall,
                                               half_diagonal - field.wall - least);
    const double by_surface = anchor.signed_distance - field.wall;
    if (by_surface + half_diagonal < least) return;
    const double bound = min_of(by_balls, by_surface) + half_diagonal;
    children[i] = {{centre, anchor.signed_distance, anchor.facet, parent.level + 1}, bound};
    fates[i] = fate_of(bound, half_diagonal, threshold, finest);
  }
};

// First list: children to halve at once, which never become cells; second: to search; third: cells.
struct TallyChildren {
  View<const CellFate> fates;

  AERATE_HD Tally operator()(std::size_t i) const {
    const bool searched = fates[i] == CellFate::searched;
    return {fates[i] == CellFate::halved ? 1u : 0u, searched ? 1u : 0u,
            searched || fates[i] == CellFate::asleep ? 1u : 0u};
  }
};

struct AppendChildren {
  View<const Child> children;
  View<const CellFate> fates;
  CellsView cells;
  std::size_t first;
  View<Cell> parents;
  View<std::uint32_t> searched;

  AERATE_HD void operator()(std::size_t i, Tally before) const {
    if (fates[i] == CellFate::dropped) return;
    if (fates[i] == CellFate::halved) {
      parents[before.first] = children[i].cell;
      return;
    }
    const std::size_t id = first + before.third;
    cells.cells[id] = children[i].cell;
    cells.bounds[id] = children[i].bound;
    if (fates[i] == CellFate::searched) searched[before.second] = static_cast<std::uint32_t>(id);
  }
};

struct TallyUseful {
  View<const double> bounds;
  double least;

  AERATE_HD Tally operator()(std::size_t i) const { return {bounds[i] >= least ? 1u : 0u, 0u, 0u}; }
};

struct KeepUseful {
  View<const Cell> cells;
  View<const double> bounds;
  double least;
  View<Child> kept;

  AERATE_HD void operator()(std::size_t i, Tally before) const {
    if (bounds[i] >= least) kept[before.first] = {cells[i], bounds[i]};
  }
};

struct PutBack {
  View<const Child> kept;
  CellsView cells;
  std::size_t first;

  AERATE_HD void operator()(std::size_t i) const {
    cells.cells[first + i] = kept[i].cell;
    cells.bounds[first + i] = kept[i].bound;
  }
};

template <typename Shape>
struct MakeRoots {
  CellsView cells;
  FieldView<Shape> field;
  Vec3d origin;
  double edge;
  std::uint32_t count_x, count_y;

  AERATE_HD void operator()(std::size_t i) const {
    const std::size_t column = i % count_x, row = i / count_x % count_y, layer = i / count_x / count_y;
    const auto x = static_cast<double>(column);
    const auto y = static_cast<double>(row);
    const auto z = static_cast<double>(layer);
    const Vec3d centre = origin + Vec3d{x + 0.5, y + 0.5, z + 0.5} * edge;
    const SurfaceAnchor anchor = anchor_at(field, {centre, 0, kNone}, centre);
    cells.cells[i] = {centre, anchor.signed_distance, anchor.facet, 0};
    cells.bounds[i] = anchor.signed_distance - field.wall + cells.root_half_diagonal;
  }
};

}  // namespace cell_tree_detail

template <typename Executor, typename Shape = BallShape>
class CellTree {
 public:
  CellTree(const Executor& executor, Paced<Executor>& paced) : executor_(executor), paced_(paced) {}

  CellsView view() { return {cells_.view(), bounds_.view(), root_half_diagonal_}; }
  // How often cells were given new numbers.
  std::size_t tidied() const { return tidied_; }

  // Covers the box; nothing is placed yet.
  //   most_at_a_time: cells and children that are worked on at a time; at least 8
  void make_roots(const FieldView<Shape>& field, const Box3d& box, std::size_t most_at_a_time) {
    most_at_a_time_ = most_at_a_time / 8 * 8;
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
                             cell_tree_detail::MakeRoots<Shape>{view(), field, box.lower, edge, nx, ny});
  }

  // Halves cells until those in which f may reach `threshold` have half diagonals of at most `finest`.
  // Returns these, ascending, valid until the next call. `least`: cells that cannot reach this are of no use.
  View<const std::uint32_t> refine(const FieldView<Shape>& field, double threshold, double finest,
                                   double least) {
    if (useful_ < cells_.size() / 2 && cells_.size() > kLeastToTidy) tidy(least);
    searched_.clear();
    parents_.clear();
    examine(field, threshold, finest, least);
    while (parents_.size() > 0) halve_parents(field, threshold, finest, least);
    return searched_.view();
  }

 private:
  static constexpr std::size_t kLeastToTidy = 4096;

  void resize(std::size_t count) {
    cells_.resize(executor_, count);
    bounds_.resize(executor_, count);
  }

  void examine(const FieldView<Shape>& field, double threshold, double finest, double least) {
    using namespace cell_tree_detail;
    useful_ = 0;
    for_each_piece(cells_.size(), most_at_a_time_, [&](std::size_t first, std::size_t count) {
      fates_.resize(executor_, count);
      paced_.for_each_index(count, Examine<Shape>{view(), field, first, threshold, finest, fates_.view()});
      const std::size_t parents = parents_.size(), searched = searched_.size();
      parents_.resize(executor_, parents + count);
      searched_.resize(executor_, searched + count);
      const Tally total =
          executor_.select(count, TallyCells{view(), fates_.view(), first, least},
                           ListCells{view(), fates_.view(), first, parents_.view_from(parents),
                                     searched_.view_from(searched)});
      parents_.resize(executor_, parents + total.first);
      searched_.resize(executor_, searched + total.second);
      useful_ += total.third;
    });
  }

  // Makes cells of the parents' children; those to be halved again become the parents.
  void halve_parents(const FieldView<Shape>& field, double threshold, double finest, double least) {
    using namespace cell_tree_detail;
    next_parents_.clear();
    for_each_piece(8 * parents_.size(), most_at_a_time_, [&](std::size_t first_child, std::size_t count) {
      children_.resize(executor_, count);
      fates_.resize(executor_, count);
      const View<const Cell> parents{parents_.view().data + first_child / 8, count / 8};
      paced_.for_each_index(count, MakeChildren<Shape>{field, root_half_diagonal_, parents, threshold, finest,
                                                       least, children_.view(), fates_.view()});
      const std::size_t cells = cells_.size(), next = next_parents_.size(), searched = searched_.size();
      resize(cells + count);
      next_parents_.resize(executor_, next + count);
      searched_.resize(executor_, searched + count);
      const Tally total =
          executor_.select(count, TallyChildren{fates_.view()},
                           AppendChildren{children_.view(), fates_.view(), view(), cells,
                                          next_parents_.view_from(next), searched_.view_from(searched)});
      resize(cells + total.third);
      next_parents_.resize(executor_, next + total.first);
      searched_.resize(executor_, searched + total.second);
      useful_ += total.third;
    });
    std::swap(parents_, next_parents_);
  }

  // Drops the cells that are of no more use; the others keep their order.
  void tidy(double least) {
    using namespace cell_tree_detail;
    std::size_t kept = 0;
    for_each_piece(cells_.size(), most_at_a_time_, [&](std::size_t first, std::size_t count) {
      children_.resize(executor_, count);
      const View<const Cell> cells{cells_.view().data + first, count};
      const View<const double> bounds{bounds_.view().data + first, count};
      const Tally total = executor_.select(count, TallyUseful{bounds, least},
                                           KeepUseful{cells, bounds, least, children_.view()});
      executor_.for_each_index(total.first, PutBack{children_.view(), view(), kept});
      kept += total.first;
    });
    resize(kept);
    ++tidied_;
  }

  const Executor& executor_;
  Paced<Executor>& paced_;
  std::size_t most_at_a_time_ = 8;
  double root_half_diagonal_ = 0;
  std::size_t useful_ = 0;  // cells, when they were last counted
  std::size_t tidied_ = 0;
  GrowingBuffer<Executor, Cell> cells_, parents_, next_parents_;
  GrowingBuffer<Executor, double> bounds_;
  GrowingBuffer<Executor, cell_tree_detail::CellFate> fates_;
  GrowingBuffer<Executor, std::uint32_t> searched_;
  GrowingBuffer<Executor, cell_tree_detail::Child> children_;
};

}  // namespace aerate::kernels
