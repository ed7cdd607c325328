#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "kernels/atomic.h"
#include "kernels/cell_grid.h"
#include "kernels/constants.h"
#include "kernels/growing_buffer.h"
#include "kernels/packed_shape.h"
#include "kernels/space_curve.h"
#include "kernels/vec.h"
#include "kernels/view.h"

// The balls placed so far, in a grid that answers which of them is nearest.

namespace aerate::kernels {

struct NearestBall {
  double clearance;    // largest radius beside it, for balls |p - c| - r - gap; the limit if none is nearer
  std::uint32_t ball;  // or kNone
};

struct BallEntry {
  std::uint32_t ball;
  std::uint32_t next;
};

// Placed balls by the cells of a uniform grid. A ball is entered in every cell from which its clearance may
// be `reach` or less, so that one cell answers a query whatever the sizes of the balls; a cell that lies
// wholly in a ball names that ball alone. The balls that are there when the grid is made are listed cell by
// cell (CSR), since a list in one piece is read three times as fast as a linked one; those that come later
// are linked. The grid is made anew with smaller cells as the largest clearance left shrinks.
template <typename Shape>
struct BallGridView {
  static constexpr std::uint32_t kInsideBit = 0x80000000u;

  CellGrid cells;
  double reach = 0;
  double gap = 0;
  View<std::uint32_t> heads;  // by cell: kNone, first entry, or kInsideBit | ball
  View<BallEntry> entries;
  View<const std::uint32_t> starts;  // by cell, and the end: where its balls are in `listed`
  View<const std::uint32_t> listed;
  View<const Ball> balls;
  Shape shape{};

  // The ball of least clearance at p, if that is below min(limit, reach). Ties go to the smaller index.
  AERATE_HD NearestBall nearest(Vec3d p, double limit) const {
    NearestBall best{min_of(limit, reach), kNone};
    const std::size_t cell = cells.index_at(p);
    const std::uint32_t head = heads[cell];
    if (head != kNone && (head & kInsideBit) != 0) {
      const std::uint32_t ball = head & ~kInsideBit;
      return {length(p - balls[ball].centre) - balls[ball].radius - gap, ball};
    }
    for (std::uint32_t i = starts[cell]; i < starts[cell + 1]; ++i) consider(p, listed[i], best);
    for (std::uint32_t i = head; i != kNone; i = entries[i].next) consider(p, entries[i].ball, best);
    return best;
  }

 private:
  AERATE_HD void consider(Vec3d p, std::uint32_t id, NearestBall& best) const {
    const Ball& ball = balls[id];
    // Most balls of a cell are farther than the best so far, which squares can tell. The slack keeps the
    // rounding of squares out of the decision, which would otherwise depend on the order of the list.
    constexpr double kSlack = 1 + 1e-14;
    const double span = shape.span(best.clearance + ball.radius + gap, max_of(best.clearance, ball.radius));
    const double distance_squared = length_squared(p - ball.centre);
    if (span < 0 || distance_squared > span * span * kSlack) return;
    const double clearance = shape.radius_beside(p, ball, gap, distance_squared);
    if (clearance < best.clearance || (clearance == best.clearance && id < best.ball)) best = {clearance, id};
  }
};

namespace ball_grid_detail {

// Squared distances from a coordinate to the nearest and the farthest point of an interval.
struct AxisDistances {
  double nearest_squared, farthest_squared;

  AERATE_HD AxisDistances(double coordinate, double lower, double size) {
    const double below = coordinate - lower;
    const double above = size - below;
    const double outside = max_of(max_of(-below, -above), 0.0);
    const double far = max_of(below, above);
    nearest_squared = outside * outside;
    farthest_squared = far * far;
  }
};

// What a ball is to a box of cells.
enum class Beside { within_ball, may_touch, out_of_reach };

struct BallKeys {
  View<const Ball> balls;
  CurveFrame frame;
  View<std::uint64_t> keys;
  View<std::uint32_t> order;

  AERATE_HD void operator()(std::size_t i) const {
    keys[i] = frame.key(balls[i].centre);
    order[i] = static_cast<std::uint32_t>(i);
  }
};

// In two steps: gathered in order, and put back.
struct ReorderBalls {
  static constexpr unsigned kSteps = 2;
  View<Ball> balls;
  View<const std::uint32_t> order;
  View<Ball> ordered;

  AERATE_HD void operator()(unsigned step, std::size_t i) const {
    if (step == 0) {
      ordered[i] = balls[order[i]];
    } else {
      balls[i] = ordered[i];
    }
  }
};

// What is done with the cells that balls are entered in. Balls that are linked take two passes, those that
// are listed the others; cells that lie wholly in a ball have to be known before.
enum class EnterPass { mark_inside_and_count, link, mark_inside_and_count_by_cell, list };

// Enters one layer of cells along z of a ball: the unit of work, so that a large ball is not one thread's.
// Most cells of a layer lie wholly in a large ball or beyond its reach, which squares of them tell at once.
template <typename Shape>
struct EnterLayer {
  static constexpr std::uint32_t kSquare = 8;  // cells along x and y

  BallGridView<Shape> grid;
  std::uint32_t first_ball;
  std::uint32_t layers;  // for each ball: at least as many as any has
  EnterPass pass;
  View<std::uint32_t> first_entries;  // by layer, written by the first pass, read by the second
  View<std::uint32_t> entry_count;    // one number: entries that are given out, in an order that nobody sees
  View<std::uint32_t> ends;  // by cell: how many balls are to be listed, then where the next one goes
  View<std::uint32_t> listed;

  AERATE_HD void operator()(std::size_t i) const {
    const std::uint32_t id = first_ball + static_cast<std::uint32_t>(i / layers);
    const Ball ball = grid.balls[id];
    const Box3d influence = grid.shape.box_of_influence(ball, grid.gap, grid.reach);
    const CellBox range(grid.cells, influence.lower, influence.upper);
    const std::uint32_t z = range.z0 + static_cast<std::uint32_t>(i % layers);
    if (z > range.z1) return;
    std::uint32_t entry = pass == EnterPass::link ? first_entries[i] : 0;
    for (std::uint32_t y = range.y0; y <= range.y1; y += kSquare) {
      for (std::uint32_t x = range.x0; x <= range.x1; x += kSquare) {
        enter_square(
            id, ball,
            CellBox{x, min_of(x + kSquare - 1, range.x1), y, min_of(y + kSquare - 1, range.y1), z, z}, entry);
      }
    }
    if (pass == EnterPass::mark_inside_and_count) first_entries[i] = atomic_add(entry_count[0], entry);
  }

 private:
  AERATE_HD void enter_square(std::uint32_t id, const Ball& ball, const CellBox& square,
                              std::uint32_t& entry) const {
    const Beside whole = beside(ball, square);
    if (whole == Beside::out_of_reach || (whole == Beside::within_ball && !marks())) return;
    for (std::uint32_t y = square.y0; y <= square.y1; ++y) {
      for (std::uint32_t x = square.x0; x <= square.x1; ++x) {
        const Beside cell =
            whole == Beside::within_ball ? whole : beside(ball, CellBox{x, x, y, y, square.z0, square.z1});
        if (cell != Beside::out_of_reach)
          enter(id, grid.cells.index(x, y, square.z0), cell == Beside::within_ball, entry);
      }
    }
  }

  AERATE_HD Beside beside(const Ball& ball, const CellBox& box) const {
    const double cell = grid.cells.cell_size;
    const Vec3d size = Vec3d{box.x1 - box.x0 + 1.0, box.y1 - box.y0 + 1.0, box.z1 - box.z0 + 1.0} * cell;
    const Vec3d lower = grid.cells.origin + Vec3d{box.x0 * 1.0, box.y0 * 1.0, box.z0 * 1.0} * cell;
    const AxisDistances x(ball.centre.x, lower.x, size.x), y(ball.centre.y, lower.y, size.y),
        z(ball.centre.z, lower.z, size.z);
    // Half the gap belongs to each ball: cells inside two balls at once cannot be.
    const double inner = ball.radius + 0.5 * grid.gap;
    if (x.farthest_squared + y.farthest_squared + z.farthest_squared <= inner * inner)
      return Beside::within_ball;
    const double nearest_squared = x.nearest_squared + y.nearest_squared + z.nearest_squared;
    const bool may_touch = grid.shape.may_touch(ball, grid.gap, grid.reach, nearest_squared,
                                                lower + size * 0.5, 0.5 * length(size));
    return may_touch ? Beside::may_touch : Beside::out_of_reach;
  }

  AERATE_HD bool marks() const {
    return pass == EnterPass::mark_inside_and_count || pass == EnterPass::mark_inside_and_count_by_cell;
  }

  // `entry`: the layer's entries so far, or the next of them.
  AERATE_HD void enter(std::uint32_t id, std::size_t cell, bool inside, std::uint32_t& entry) const {
    if (inside) {
      if (marks()) grid.heads[cell] = BallGridView<Shape>::kInsideBit | id;
      return;
    }
    switch (pass) {
      case EnterPass::mark_inside_and_count:
        ++entry;
        return;
      case EnterPass::link: {
        const std::uint32_t head = atomic_load(grid.heads[cell]);
        if (head != kNone && (head & BallGridView<Shape>::kInsideBit) != 0) return;
        grid.entries[entry].ball = id;
        grid.entries[entry].next = atomic_exchange(grid.heads[cell], entry);
        ++entry;
        return;
      }
      case EnterPass::mark_inside_and_count_by_cell:
        atomic_add(ends[cell], 1);
        return;
      case EnterPass::list:
        if (grid.heads[cell] != kNone) return;
        // The order depends on timing, which no query can see.
        listed[atomic_add(ends[cell], 1)] = id;
        return;
    }
  }
};

// A cell that lies wholly in a ball lists none.
struct ListNoneWithin {
  View<const std::uint32_t> heads;
  View<std::uint32_t> counts;

  AERATE_HD void operator()(std::size_t cell) const {
    if (heads[cell] != kNone) counts[cell] = 0;
  }
};

}  // namespace ball_grid_detail

// Puts balls into the order of a curve that fills the box: those near in space are asked for together, and
// should be near in memory.
template <typename Executor>
class BallOrder {
 public:
  void order(const Executor& executor, const Box3d& box, View<Ball> balls) {
    using namespace ball_grid_detail;
    if (balls.size < 2) return;
    keys_.resize(executor, balls.size);
    order_.resize(executor, balls.size);
    ordered_.resize(executor, balls.size);
    executor.for_each_index(balls.size, BallKeys{balls, CurveFrame(box), keys_.view(), order_.view()});
    executor.sort_pairs(keys_.view(), order_.view());
    executor.for_each_step(ReorderBalls::kSteps, balls.size,
                           ReorderBalls{balls, order_.view(), ordered_.view()});
  }

 private:
  GrowingBuffer<Executor, std::uint64_t> keys_;
  GrowingBuffer<Executor, std::uint32_t> order_;
  GrowingBuffer<Executor, Ball> ordered_;
};

template <typename Executor, typename Shape = BallShape>
class BallGrid {
 public:
  explicit BallGrid(const Executor& executor, const Shape& shape = {})
      : executor_(executor), entry_count_(executor.template allocate<std::uint32_t>(1)) {
    view_.shape = shape;
  }

  BallGridView<Shape> view() { return view_; }
  double reach() const { return view_.reach; }
  // No cell of a grid over the box should be smaller, for memory's sake.
  double least_cell(const Box3d& box) const { return cell_of(box, fitting_cells()); }

  // A grid over the box for clearances up to `reach`, with all balls that have been entered so far.
  //   most_at_a_time: layers of balls that are worked on at a time, four bytes each
  void reset(const Box3d& box, double reach, double gap, std::size_t most_at_a_time) {
    constexpr double kCellToReach = 4;  // smaller cells cost more to fill than they save
    most_at_a_time_ = most_at_a_time;
    view_.reach = reach;
    view_.gap = gap;
    view_.cells = make_cell_grid(box, max_of(kCellToReach * reach, cell_of(box, useful_cells())));
    const std::size_t count = view_.cells.cell_count();
    if (heads_.size() < count) {
      heads_ = {};
      starts_ = {};
      heads_ = executor_.template allocate<std::uint32_t>(count);
      starts_ = executor_.template allocate<std::uint32_t>(count + 1);
    }
    view_.heads = {heads_.view().data, count};
    list_all();
  }

  // Enters the balls from `first` on, none larger than `largest`. All stay where they are until the next
  // call.
  void enter(View<const Ball> balls, std::size_t first, double largest) {
    constexpr std::size_t kFew = 1000;
    view_.balls = balls;
    if (balls.size == first) return;
    // Balls of about the same size are entered together.
    if (groups_.empty() || largest < 0.5 * groups_.back().largest) groups_.push_back({first, largest});
    groups_.back().largest = max_of(groups_.back().largest, largest);
    // They are listed again where the linked ones are many, and were as much work as all others are: large balls in
    // small cells are.
    linked_work_ += work_of(balls.size - first, largest);
    double work = 0;
    for (std::size_t k = 0; k < groups_.size(); ++k)
      work += work_of(end_of(k) - groups_[k].first, groups_[k].largest);
    const bool pays = 4 * linked_work_ > work;
    const bool are_many = pays && balls.size - first > kFew && balls.size - first > first / 5;
    if (!are_many) link(first, balls.size, largest);
    if (are_many || (pays && entries_.size() > kFew && entries_.size() > view_.listed.size / 5)) list_all();
  }

 private:
  struct Group {
    std::size_t first;
    double largest;
  };

  // The edge of cells of which so many fill the box.
  double cell_of(const Box3d& box, std::size_t count) const {
    const Vec3d size = box.upper - box.lower;
    const double volume =
        max_of(size.x, view_.reach) * max_of(size.y, view_.reach) * max_of(size.z, view_.reach);
    return std::cbrt(volume / static_cast<double>(count));
  }

  // More would be of use to few models; and no more than an eighth of the memory.
  std::size_t fitting_cells() const {
    constexpr std::size_t kMost = std::size_t{1} << 25;
    const std::size_t fitting = executor_.free_bytes() / 8 / sizeof(std::uint32_t);
    return max_of(min_of(fitting, kMost), std::size_t{1024});
  }

  // Large balls are entered in all cells along their surfaces: cells beyond what the balls have use for take
  // longer to fill than all searches do (docs/packing.md).
  std::size_t useful_cells() const {
    constexpr std::size_t kFewest = std::size_t{1} << 16, kPerBall = 32;
    return min_of(max_of(kFewest, kPerBall * view_.balls.size), fitting_cells());
  }

  std::size_t end_of(std::size_t group) const {
    return group + 1 < groups_.size() ? groups_[group + 1].first : view_.balls.size;
  }

  // Cells that are looked at, about.
  double work_of(std::size_t count, double largest) const {
    const double layers = layers_of(largest);
    return static_cast<double>(count) * layers * layers * layers;
  }

  // At most so many layers of cells along z has a ball no larger than `largest`.
  std::uint32_t layers_of(double largest) const {
    const double beside = view_.shape.span(2 * (largest + view_.gap + view_.reach), largest);
    const double across = view_.shape.span(beside, view_.reach) * view_.cells.cells_per_mm;
    return static_cast<std::uint32_t>(min_of(across + 3, view_.cells.count_z * 1.0));
  }

  // Lists the balls that are known so far, cell by cell; none are linked then.
  void list_all() {
    using namespace ball_grid_detail;
    const std::size_t count = view_.heads.size;
    executor_.for_each_index(count, SetAll<std::uint32_t>{view_.heads, kNone});
    executor_.for_each_index(1, SetAll<std::uint32_t>{entry_count_.view(), 0});
    entries_.clear();
    view_.entries = {};
    // Where a cell's balls end is where the next one's begin: one array counts them, says where the next
    // ball goes, and has all starts in the end, the first of which is 0.
    const View<std::uint32_t> starts{starts_.view().data, count + 1};
    const View<std::uint32_t> ends{starts.data + 1, count};
    executor_.for_each_index(count + 1, SetAll<std::uint32_t>{starts, 0});
    for_each_layer(EnterPass::mark_inside_and_count_by_cell, ends);
    executor_.for_each_index(count, ListNoneWithin{view_.heads, ends});
    const std::uint64_t total = executor_.exclusive_scan(View<const std::uint32_t>(ends), ends);
    require_fewer_than_bits(total);
    view_.starts = starts;
    listed_ = {};
    listed_ = executor_.template allocate<std::uint32_t>(static_cast<std::size_t>(total));
    for_each_layer(EnterPass::list, ends);
    view_.listed = listed_.view();
    linked_work_ = 0;
  }

  void for_each_layer(ball_grid_detail::EnterPass pass, View<std::uint32_t> ends) {
    for (std::size_t k = 0; k < groups_.size(); ++k) {
      const std::size_t last = end_of(k);
      const std::uint32_t layers = layers_of(groups_[k].largest);
      executor_.for_each_index(
          (last - groups_[k].first) * layers,
          ball_grid_detail::EnterLayer<Shape>{view_,
                                              static_cast<std::uint32_t>(groups_[k].first),
                                              layers,
                                              pass,
                                              {},
                                              {},
                                              ends,
                                              listed_.view()});
    }
  }

  static void require_fewer_than_bits(std::uint64_t entries) {
    if (entries >= BallGridView<Shape>::kInsideBit) {
      throw std::length_error("ball grid: more than 2^31 - 1 entries");
    }
  }

  void link(std::size_t first, std::size_t last, double largest) {
    using namespace ball_grid_detail;
    const std::uint32_t layers = layers_of(largest);
    const std::size_t at_a_time = max_of(most_at_a_time_ / layers, std::size_t{1});
    for (std::size_t begin = first; begin < last; begin += at_a_time) {
      const std::size_t count = min_of(at_a_time, last - begin) * layers;
      first_entries_.resize(executor_, count);
      EnterLayer<Shape> layer{view_,
                              static_cast<std::uint32_t>(begin),
                              layers,
                              EnterPass::mark_inside_and_count,
                              first_entries_.view(),
                              entry_count_.view(),
                              {},
                              {}};
      executor_.for_each_index(count, layer);
      const std::uint32_t entries = executor_.download(View<const std::uint32_t>(entry_count_.view())).at(0);
      require_fewer_than_bits(entries);
      entries_.resize(executor_, entries);
      view_.entries = entries_.view();
      layer.grid = view_;
      layer.pass = EnterPass::link;
      executor_.for_each_index(count, layer);
    }
  }

  const Executor& executor_;
  BallGridView<Shape> view_;
  std::size_t most_at_a_time_ = 1;
  std::vector<Group> groups_;
  double linked_work_ = 0;  // since all were listed
  typename Executor::template Buffer<std::uint32_t> heads_, starts_, listed_, entry_count_;
  GrowingBuffer<Executor, std::uint32_t> first_entries_;
  GrowingBuffer<Executor, BallEntry> entries_;
};

}  // namespace aerate::kernels
