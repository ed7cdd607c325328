#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "kernels/atomic.h"
#include "kernels/growing_buffer.h"
#include "kernels/vec.h"
#include "kernels/view.h"
#include "kernels/winding.h"

// The balls placed so far, in a grid that answers which of them is nearest.

namespace aerate::kernels {

struct Ball {
  Vec3d centre;
  double radius;
};

inline constexpr std::uint32_t kNoBall = 0xffffffffu;
inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

struct NearestBall {
  double clearance;  // |p - c| - r - gap, or the limit if no ball is nearer
  std::uint32_t ball;
};

struct BallEntry {
  std::uint32_t ball;
  std::uint32_t next;
};

// Placed balls by the cells of a uniform grid. A ball is entered in every cell from which its clearance may
// be `reach` or less, so that one cell answers a query whatever the sizes of the balls; a cell that lies
// wholly in a ball names that ball alone. The grid is rebuilt with smaller cells as the largest clearance
// left shrinks.
struct BallGridView {
  static constexpr std::uint32_t kEmpty = 0xffffffffu;
  static constexpr std::uint32_t kInsideBit = 0x80000000u;

  Vec3d origin{0, 0, 0};
  double cell = 1;
  double cells_per_mm = 1;
  std::uint32_t count_x = 1, count_y = 1, count_z = 1;
  double reach = 0;
  double gap = 0;
  View<std::uint32_t> heads;  // by cell: kEmpty, first entry, or kInsideBit | ball
  View<BallEntry> entries;
  View<const Ball> balls;

  AERATE_HD std::uint32_t cell_x(double x) const {
    return ColumnGrid::cell_of(x - origin.x, cells_per_mm, count_x);
  }
  AERATE_HD std::uint32_t cell_y(double y) const {
    return ColumnGrid::cell_of(y - origin.y, cells_per_mm, count_y);
  }
  AERATE_HD std::uint32_t cell_z(double z) const {
    return ColumnGrid::cell_of(z - origin.z, cells_per_mm, count_z);
  }
  AERATE_HD std::size_t index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (static_cast<std::size_t>(z) * count_y + y) * count_x + x;
  }

  // The ball of least clearance at p, if that is below min(limit, reach). Ties go to the smaller index.
  AERATE_HD NearestBall nearest(Vec3d p, double limit) const {
    NearestBall best{min_of(limit, reach), kNoBall};
    const std::uint32_t head = heads[index(cell_x(p.x), cell_y(p.y), cell_z(p.z))];
    if (head == kEmpty) return best;
    if ((head & kInsideBit) != 0) {
      const std::uint32_t ball = head & ~kInsideBit;
      return {length(p - balls[ball].centre) - balls[ball].radius - gap, ball};
    }
    for (std::uint32_t i = head; i != kEmpty; i = entries[i].next) {
      const std::uint32_t id = entries[i].ball;
      const Ball ball = balls[id];
      // Most balls of a cell are farther than the best so far, which squares can tell. The slack keeps the
      // rounding of squares out of the decision, which would otherwise depend on the order of the list.
      constexpr double kSlack = 1 + 1e-14;
      const double span = best.clearance + ball.radius + gap;
      const double distance_squared = length_squared(p - ball.centre);
      if (span < 0 || distance_squared > span * span * kSlack) continue;
      const double clearance = std::sqrt(distance_squared) - ball.radius - gap;
      if (clearance < best.clearance || (clearance == best.clearance && id < best.ball)) {
        best = {clearance, id};
      }
    }
    return best;
  }
};

namespace ball_grid_detail {

struct CellRange {
  std::uint32_t x0, x1, y0, y1, z0, z1;

  AERATE_HD CellRange(const BallGridView& grid, Vec3d centre, double radius)
      : x0(grid.cell_x(centre.x - radius)),
        x1(grid.cell_x(centre.x + radius)),
        y0(grid.cell_y(centre.y - radius)),
        y1(grid.cell_y(centre.y + radius)),
        z0(grid.cell_z(centre.z - radius)),
        z1(grid.cell_z(centre.z + radius)) {}
};

// Squared distances from a coordinate to the nearest and the farthest point of a cell along one axis.
struct AxisDistances {
  double nearest_squared, farthest_squared;

  AERATE_HD AxisDistances(double coordinate, double origin, double cell, std::uint32_t i) {
    const double below = coordinate - (origin + cell * i);
    const double above = cell - below;
    const double outside = max_of(max_of(-below, -above), 0.0);
    const double far = max_of(below, above);
    nearest_squared = outside * outside;
    farthest_squared = far * far;
  }
};

// A ball's layers of cells along z: the unit of work, so that a large ball is not one thread's.
struct CountLayers {
  BallGridView grid;
  std::uint32_t first_ball;
  View<std::uint32_t> layers;

  AERATE_HD void operator()(std::size_t i) const {
    const Ball ball = grid.balls[first_ball + i];
    const CellRange range(grid, ball.centre, ball.radius + grid.gap + grid.reach);
    layers[i] = range.z1 - range.z0 + 1;
  }
};

struct ListLayers {
  View<const std::uint32_t> offsets;
  View<const std::uint32_t> layers;
  View<std::uint32_t> layer_ball;
  View<std::uint32_t> layer_index;

  AERATE_HD void operator()(std::size_t i) const {
    for (std::uint32_t k = 0; k < layers[i]; ++k) {
      layer_ball[offsets[i] + k] = static_cast<std::uint32_t>(i);
      layer_index[offsets[i] + k] = k;
    }
  }
};

enum class EnterPass { mark_inside_and_count, link };

struct EnterLayer {
  BallGridView grid;
  std::uint32_t first_ball;
  View<const std::uint32_t> layer_ball;
  View<const std::uint32_t> layer_index;
  EnterPass pass;
  View<std::uint32_t> counts;         // by layer, written by the first pass
  View<const std::uint32_t> offsets;  // by layer, read by the second
  std::uint32_t first_entry;

  AERATE_HD void operator()(std::size_t layer) const {
    const std::uint32_t id = first_ball + layer_ball[layer];
    const Ball ball = grid.balls[id];
    const double outer = ball.radius + grid.gap + grid.reach;
    // Half the gap belongs to each ball: cells inside two balls at once cannot be.
    const double inner = ball.radius + 0.5 * grid.gap;
    const CellRange range(grid, ball.centre, outer);
    const std::uint32_t z = range.z0 + layer_index[layer];
    const AxisDistances dz(ball.centre.z, grid.origin.z, grid.cell, z);
    std::uint32_t entry = pass == EnterPass::link ? first_entry + offsets[layer] : 0;
    for (std::uint32_t y = range.y0; y <= range.y1; ++y) {
      const AxisDistances dy(ball.centre.y, grid.origin.y, grid.cell, y);
      for (std::uint32_t x = range.x0; x <= range.x1; ++x) {
        const AxisDistances dx(ball.centre.x, grid.origin.x, grid.cell, x);
        if (dx.nearest_squared + dy.nearest_squared + dz.nearest_squared > outer * outer) continue;
        const std::size_t cell = grid.index(x, y, z);
        const bool inside = dx.farthest_squared + dy.farthest_squared + dz.farthest_squared <= inner * inner;
        if (pass == EnterPass::mark_inside_and_count) {
          if (inside) {
            grid.heads[cell] = BallGridView::kInsideBit | id;
          } else {
            ++entry;
          }
        } else if (!inside) {
          // A slot is used up even where the cell lies in another ball: offsets must not depend on that.
          const std::uint32_t head = atomic_load(grid.heads[cell]);
          if (head == BallGridView::kEmpty || (head & BallGridView::kInsideBit) == 0) {
            grid.entries[entry].ball = id;
            grid.entries[entry].next = atomic_exchange(grid.heads[cell], entry);
          }
          ++entry;
        }
      }
    }
    if (pass == EnterPass::mark_inside_and_count) counts[layer] = entry;
  }
};

}  // namespace ball_grid_detail

template <typename Executor>
class BallGrid {
 public:
  explicit BallGrid(const Executor& executor) : executor_(executor) {}

  BallGridView view() { return view_; }
  double reach() const { return view_.reach; }
  double cell() const { return view_.cell; }

  // An empty grid over the box for clearances up to `reach`.
  void reset(const Box3d& box, double reach, double gap) {
    constexpr double kMostCells = 1 << 25;
    const Vec3d size = box.upper - box.lower;
    const double volume = max_of(size.x, reach) * max_of(size.y, reach) * max_of(size.z, reach);
    const double cell = max_of(reach, std::cbrt(volume / kMostCells));
    view_.origin = box.lower;
    view_.cell = cell;
    view_.cells_per_mm = 1 / cell;
    view_.count_x = static_cast<std::uint32_t>(size.x / cell) + 1;
    view_.count_y = static_cast<std::uint32_t>(size.y / cell) + 1;
    view_.count_z = static_cast<std::uint32_t>(size.z / cell) + 1;
    view_.reach = reach;
    view_.gap = gap;
    const std::size_t count = std::size_t{view_.count_x} * view_.count_y * view_.count_z;
    if (heads_.size() < count) heads_ = executor_.template allocate<std::uint32_t>(count);
    view_.heads = {heads_.view().data, count};
    executor_.for_each_index(count, SetAll<std::uint32_t>{view_.heads, BallGridView::kEmpty});
    entries_.resize(executor_, 0);
  }

  // Enters the balls from `first` on. All stay where they are until the next call or `reset`.
  void enter(View<const Ball> balls, std::size_t first) {
    using namespace ball_grid_detail;
    const std::size_t count = balls.size - first;
    view_.balls = balls;
    if (count == 0) return;
    const auto first_ball = static_cast<std::uint32_t>(first);
    auto layers = executor_.template allocate<std::uint32_t>(count);
    auto layer_offsets = executor_.template allocate<std::uint32_t>(count);
    executor_.for_each_index(count, CountLayers{view_, first_ball, layers.view()});
    const std::size_t total = executor_.exclusive_scan(layers.view(), layer_offsets.view());
    auto layer_ball = executor_.template allocate<std::uint32_t>(total);
    auto layer_index = executor_.template allocate<std::uint32_t>(total);
    executor_.for_each_index(
        count, ListLayers{layer_offsets.view(), layers.view(), layer_ball.view(), layer_index.view()});
    auto counts = executor_.template allocate<std::uint32_t>(total);
    auto offsets = executor_.template allocate<std::uint32_t>(total);
    executor_.for_each_index(total,
                             EnterLayer{view_, first_ball, layer_ball.view(), layer_index.view(),
                                        EnterPass::mark_inside_and_count, counts.view(), offsets.view(), 0});
    const std::size_t added = executor_.exclusive_scan(counts.view(), offsets.view());
    const std::size_t before = entries_.size();
    entries_.resize(executor_, before + added);
    view_.entries = entries_.view();
    executor_.for_each_index(
        total, EnterLayer{view_, first_ball, layer_ball.view(), layer_index.view(), EnterPass::link,
                          counts.view(), offsets.view(), static_cast<std::uint32_t>(before)});
  }

 private:
  const Executor& executor_;
  BallGridView view_;
  typename Executor::template Buffer<std::uint32_t> heads_;
  GrowingBuffer<Executor, BallEntry> entries_;
};

}  // namespace aerate::kernels
