#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/adaptive_cells.h"
#include "kernels/atomic.h"
#include "kernels/cell_grid.h"
#include "kernels/constants.h"
#include "kernels/growing_buffer.h"
#include "kernels/paced.h"
#include "kernels/packed_shape.h"
#include "kernels/tally.h"
#include "kernels/vec.h"
#include "kernels/view.h"

// Cells from which no ball comes to rest, which are not searched again before a ball is placed where that was
// looked for: most of a model that fills up from one side is far from the balls that fill it.

namespace aerate::kernels {

// From the centre of a cell to where a ball that was pulled from there ended without coming to rest.
struct IdlePath {
  float x, y, z;          // mm
  std::uint32_t is_idle;  // 0: the cell is to be searched

  static AERATE_HD IdlePath along(Vec3d path) {
    return {static_cast<float>(path.x), static_cast<float>(path.y), static_cast<float>(path.z), 1};
  }
  static AERATE_HD IdlePath none() { return {0, 0, 0, 0}; }
  AERATE_HD Vec3d path() const { return to_double(Vec3f{x, y, z}); }
};

namespace idle_detail {

AERATE_HD inline double squared_distance_to_segment(Vec3d p, Vec3d start, Vec3d path) {
  const double squared = length_squared(path);
  const double along = squared > 0 ? dot(p - start, path) / squared : 0.0;
  return length_squared(p - start - path * min_of(max_of(along, 0.0), 1.0));
}

// The balls of the last round in a grid of linked lists.
struct NewBalls {
  CellGrid cells;
  View<std::uint32_t> heads;
  View<std::uint32_t> next;
  View<const Ball> balls;

  AERATE_HD bool any_within(double distance, Vec3d start, Vec3d path) const {
    const Vec3d end = start + path, around{distance, distance, distance};
    const CellBox range(cells, min_of(start, end) - around, max_of(start, end) + around);
    for (std::uint32_t z = range.z0; z <= range.z1; ++z) {
      for (std::uint32_t y = range.y0; y <= range.y1; ++y) {
        for (std::uint32_t x = range.x0; x <= range.x1; ++x) {
          for (std::uint32_t j = heads[cells.index(x, y, z)]; j != kNone; j = next[j]) {
            if (squared_distance_to_segment(balls[j].centre, start, path) < distance * distance) return true;
          }
        }
      }
    }
    return false;
  }
};

struct LinkBall {
  NewBalls grid;

  AERATE_HD void operator()(std::size_t i) const {
    grid.next[i] =
        atomic_exchange(grid.heads[grid.cells.index_at(grid.balls[i].centre)], static_cast<std::uint32_t>(i));
  }
};

// Whether each cell of a list is to be searched.
struct Wake {
  CellsView cells;
  View<const std::uint32_t> list;
  View<const IdlePath> paths;
  NewBalls balls;
  double near;
  View<std::uint8_t> awake;

  AERATE_HD void operator()(std::size_t i) const {
    const std::uint32_t id = list[i];
    const IdlePath path = paths[id];
    awake[i] = path.is_idle == 0 || balls.any_within(near, cells.cells[id].centre, path.path())
                   ? std::uint8_t{1}
                   : std::uint8_t{0};
  }
};

struct ListAwake {
  View<const std::uint32_t> list;
  View<const std::uint8_t> awake;
  View<std::uint32_t> chosen;

  AERATE_HD void operator()(std::size_t i, Tally before) const {
    if (awake[i] != 0) chosen[before.first] = list[i];
  }
};

}  // namespace idle_detail

template <typename Executor>
class IdleCells {
 public:
  explicit IdleCells(const Executor& executor) : executor_(executor) {}

  // For balls that are placed in the box beside those that stand there, which are so many.
  //   near: from where a ball was moved to the centres of those that may stop it, mm
  void reset(const Box3d& box, double near, double least_cell, std::size_t known_balls) {
    known_balls_ = known_balls;
    near_ = near;
    new_balls_.cells = make_cell_grid(box, max_of(2 * near, least_cell));
    heads_ = executor_.template allocate<std::uint32_t>(new_balls_.cells.cell_count());
    paths_.clear();
  }

  // Of a list of cells those to be searched, ascending as they were, valid until the next call.
  //   tidied: how often the tree has given its cells new numbers; all are awake then
  //   balls:  all that stand; those before that were known to the last call are the same
  View<const std::uint32_t> awake(const CellsView& cells, View<const std::uint32_t> list, std::size_t tidied,
                                  GrowingBuffer<Executor, Ball>& balls) {
    using namespace idle_detail;
    const View<const Ball> new_balls = balls.view_from(known_balls_);
    known_balls_ = balls.size();
    if (tidied != tidied_) paths_.clear();
    tidied_ = tidied;
    const std::size_t known = paths_.size();
    paths_.resize(executor_, cells.cells.size);
    executor_.for_each_index(paths_.size() - known,
                             SetAll<IdlePath>{paths_.view_from(known), IdlePath::none()});
    next_.resize(executor_, new_balls.size);
    new_balls_.heads = heads_.view();
    new_balls_.next = next_.view();
    new_balls_.balls = new_balls;
    executor_.for_each_index(new_balls_.heads.size, SetAll<std::uint32_t>{new_balls_.heads, kNone});
    executor_.for_each_index(new_balls.size, LinkBall{new_balls_});
    awake_.resize(executor_, list.size);
    chosen_.resize(executor_, list.size);
    executor_.for_each_index(list.size, Wake{cells, list, paths_.view(), new_balls_, near_, awake_.view()});
    const Tally total = executor_.select(list.size, TallyMarked{awake_.view()},
                                         ListAwake{list, awake_.view(), chosen_.view()});
    chosen_.resize(executor_, total.first);
    return chosen_.view();
  }

  // By cell; what is searched says how it ended.
  View<IdlePath> paths() { return paths_.view(); }

 private:
  const Executor& executor_;
  double near_ = 0;
  std::size_t tidied_ = 0;
  std::size_t known_balls_ = 0;
  idle_detail::NewBalls new_balls_{};
  typename Executor::template Buffer<std::uint32_t> heads_;
  GrowingBuffer<Executor, IdlePath> paths_;
  GrowingBuffer<Executor, std::uint32_t> next_, chosen_;
  GrowingBuffer<Executor, std::uint8_t> awake_;
};

}  // namespace aerate::kernels
