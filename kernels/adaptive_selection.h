#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "kernels/atomic.h"
#include "kernels/ball_grid.h"
#include "kernels/cell_grid.h"
#include "kernels/constants.h"
#include "kernels/growing_buffer.h"
#include "kernels/paced.h"
#include "kernels/packed_shape.h"
#include "kernels/tally.h"
#include "kernels/vec.h"
#include "kernels/view.h"

// Which of many candidates become balls: every one that meets no larger one (priority-parallel acceptance).

namespace aerate::kernels {

struct Candidate {
  Vec3d point;
  double value;
};

// Sorts candidates, the greatest rank first.
AERATE_HD inline std::uint64_t rank_key(double rank) {
  union {
    double value;
    std::uint64_t bits;
  } convert;
  convert.value = rank;
  // Doubles sort as their bits do, once negative ones are turned over.
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return (convert.bits & kSign) != 0 ? convert.bits : ~convert.bits & ~kSign;
}

namespace selection_detail {

enum class Verdict : std::uint8_t { undecided, accepted, rejected };

// Candidates in a grid of linked lists, by rank.
template <typename Shape>
struct CandidateGrid {
  CellGrid cells;
  View<std::uint32_t> heads;
  View<std::uint32_t> next;
  double gap = 0;
  Shape shape{};

  // Do the voids of two candidates come nearer to each other than the gap?
  AERATE_HD bool meet(const Candidate& a, const Candidate& b) const {
    const double span = shape.span(a.value + b.value + gap, max_of(a.value, b.value));
    return length_squared(a.point - b.point) < span * span &&
           shape.comes_nearer({a.point, a.value}, {b.point, b.value}, gap);
  }
};

// All that happens to ranked candidates until it is known which are accepted, step by step: they are linked,
// decided on in several passes, and unlinked. A chain of candidates that wait for each other may stay
// undecided; those get their turn in the next round.
template <typename Shape>
struct Decide {
  static constexpr unsigned kPasses = 4;
  static constexpr unsigned kSteps = kPasses + 2;

  CandidateGrid<Shape> grid;
  View<const Candidate> unranked;
  View<const std::uint32_t> order;
  View<Candidate> ranked;
  View<Verdict> even, odd;  // verdicts before and after passes of even number; in `even` at last

  AERATE_HD void operator()(unsigned step, std::size_t i) const {
    if (step == 0) {
      link(i);
    } else if (step <= kPasses) {
      if (step % 2 == 1) {
        odd[i] = verdict_on(i, even);
      } else {
        even[i] = verdict_on(i, odd);
      }
    } else {
      // Several threads may store the same value.
      atomic_exchange(grid.heads[grid.cells.index_at(ranked[i].point)], kNone);
    }
  }

 private:
  static_assert(kPasses % 2 == 0);

  AERATE_HD void link(std::size_t i) const {
    const Candidate candidate = unranked[order[i]];
    ranked[i] = candidate;
    even[i] = Verdict::undecided;
    grid.next[i] =
        atomic_exchange(grid.heads[grid.cells.index_at(candidate.point)], static_cast<std::uint32_t>(i));
  }

  AERATE_HD Verdict verdict_on(std::size_t i, View<const Verdict> before) const {
    if (before[i] != Verdict::undecided) return before[i];
    const Candidate me = ranked[i];
    bool blocked = false;
    const CellGrid& cells = grid.cells;
    const std::uint32_t cx = cells.cell_x(me.point.x), cy = cells.cell_y(me.point.y),
                        cz = cells.cell_z(me.point.z);
    for (std::uint32_t z = cz == 0 ? 0 : cz - 1; z <= cz + 1 && z < cells.count_z; ++z) {
      for (std::uint32_t y = cy == 0 ? 0 : cy - 1; y <= cy + 1 && y < cells.count_y; ++y) {
        for (std::uint32_t x = cx == 0 ? 0 : cx - 1; x <= cx + 1 && x < cells.count_x; ++x) {
          for (std::uint32_t j = grid.heads[cells.index(x, y, z)]; j != kNone; j = grid.next[j]) {
            if (j >= i || before[j] == Verdict::rejected) continue;
            const Candidate other = ranked[j];
            if (!grid.meet(me, other)) continue;
            if (before[j] == Verdict::accepted) return Verdict::rejected;
            blocked = true;
          }
        }
      }
    }
    return blocked ? Verdict::undecided : Verdict::accepted;
  }
};

struct TallyAccepted {
  View<const Verdict> verdicts;

  AERATE_HD Tally operator()(std::size_t i) const {
    return {verdicts[i] == Verdict::accepted ? 1u : 0u, 0u, 0u};
  }
};

struct PlaceAccepted {
  View<const Candidate> candidates;
  View<const Verdict> verdicts;
  View<Ball> balls;  // as many as there is room for

  AERATE_HD void operator()(std::size_t i, Tally before) const {
    if (verdicts[i] == Verdict::accepted && before.first < balls.size) {
      balls[before.first] = {candidates[i].point, candidates[i].value};
    }
  }
};

}  // namespace selection_detail

template <typename Executor, typename Shape = BallShape>
class CandidateSelection {
 public:
  CandidateSelection(const Executor& executor, Paced<Executor>& paced, const Shape& shape = {})
      : executor_(executor), paced_(paced) {
    grid_.shape = shape;
  }

  // For candidates in the box with values up to `largest`.
  void reset(const Box3d& box, double largest, double gap, double least_cell) {
    const double span = grid_.shape.span(2 * largest + gap, largest);
    grid_.cells = make_cell_grid(box, max_of(span, least_cell) * 1.000001);
    grid_.gap = gap;
    const std::size_t cells = grid_.cells.cell_count();
    if (heads_.size() < cells) heads_ = executor_.template allocate<std::uint32_t>(cells);
    grid_.heads = {heads_.view().data, cells};
    executor_.for_each_index(cells, SetAll<std::uint32_t>{grid_.heads, kNone});
  }

  // Appends balls, at most `most`, for those candidates that meet no larger one. Of candidates alike the
  // first wins.
  //   keys, order: their `rank_key`s and indices, in order; left sorted
  void place(View<const Candidate> candidates, View<std::uint64_t> keys, View<std::uint32_t> order,
             std::size_t most, GrowingBuffer<Executor, Ball>& balls) {
    using namespace selection_detail;
    const std::size_t count = candidates.size;
    executor_.sort_pairs(keys, order);
    ranked_.resize(executor_, count);
    next_.resize(executor_, count);
    verdicts_.resize(executor_, count);
    other_verdicts_.resize(executor_, count);
    grid_.next = next_.view();
    paced_.for_each_step(
        Decide<Shape>::kSteps, count,
        Decide<Shape>{grid_, candidates, order, ranked_.view(), verdicts_.view(), other_verdicts_.view()});
    const std::size_t first = balls.size();
    balls.resize(executor_, first + std::min(count, most));
    const Tally accepted =
        executor_.select(count, TallyAccepted{verdicts_.view()},
                         PlaceAccepted{ranked_.view(), verdicts_.view(), balls.view_from(first)});
    balls.resize(executor_, first + std::min<std::size_t>(accepted.first, most));
  }

 private:
  const Executor& executor_;
  Paced<Executor>& paced_;
  selection_detail::CandidateGrid<Shape> grid_;
  typename Executor::template Buffer<std::uint32_t> heads_;
  GrowingBuffer<Executor, std::uint32_t> next_;
  GrowingBuffer<Executor, Candidate> ranked_;
  GrowingBuffer<Executor, selection_detail::Verdict> verdicts_, other_verdicts_;
};

}  // namespace aerate::kernels
