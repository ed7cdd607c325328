#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "kernels/atomic.h"
#include "kernels/ball_grid.h"
#include "kernels/growing_buffer.h"
#include "kernels/paced.h"
#include "kernels/vec.h"
#include "kernels/view.h"
#include "kernels/winding.h"

// Which of many candidates become balls: every one that meets no larger one (priority-parallel acceptance).

namespace aerate::kernels {

struct Candidate {
  Vec3d point;
  double value;
};

namespace selection_detail {

struct RankKeys {
  View<const Candidate> candidates;
  View<const std::uint32_t> list;
  View<std::uint64_t> keys;
  View<std::uint32_t> order;

  AERATE_HD void operator()(std::size_t i) const {
    union {
      double value;
      std::uint64_t bits;
    } convert;
    convert.value = candidates[list[i]].value;
    keys[i] = ~convert.bits;  // positive doubles sort as their bits do; largest first
    order[i] = list[i];
  }
};

struct Gather {
  View<const Candidate> from;
  View<const std::uint32_t> order;
  View<Candidate> to;

  AERATE_HD void operator()(std::size_t i) const { to[i] = from[order[i]]; }
};

enum class Verdict : std::uint32_t { undecided, accepted, rejected };

// Candidates in a grid of linked lists, by rank.
struct CandidateGrid {
  Vec3d origin{0, 0, 0};
  double cells_per_mm = 1;
  std::uint32_t count_x = 1, count_y = 1, count_z = 1;
  View<std::uint32_t> heads;
  View<std::uint32_t> next;
  View<const Candidate> candidates;
  double gap = 0;

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
  AERATE_HD std::size_t cell_of(Vec3d p) const { return index(cell_x(p.x), cell_y(p.y), cell_z(p.z)); }
};

struct LinkCandidates {
  CandidateGrid grid;
  AERATE_HD void operator()(std::size_t i) const {
    grid.next[i] =
        atomic_exchange(grid.heads[grid.cell_of(grid.candidates[i].point)], static_cast<std::uint32_t>(i));
  }
};

struct UnlinkCandidates {
  CandidateGrid grid;
  AERATE_HD void operator()(std::size_t i) const {
    // Several threads may store the same value.
    atomic_exchange(grid.heads[grid.cell_of(grid.candidates[i].point)], kNoBall);
  }
};

struct Decide {
  CandidateGrid grid;
  View<const Verdict> before;
  View<Verdict> after;

  AERATE_HD void operator()(std::size_t i) const {
    after[i] = before[i];
    if (before[i] != Verdict::undecided) return;
    const Candidate me = grid.candidates[i];
    bool blocked = false;
    const std::uint32_t cx = grid.cell_x(me.point.x), cy = grid.cell_y(me.point.y),
                        cz = grid.cell_z(me.point.z);
    for (std::uint32_t z = cz == 0 ? 0 : cz - 1; z <= cz + 1 && z < grid.count_z; ++z) {
      for (std::uint32_t y = cy == 0 ? 0 : cy - 1; y <= cy + 1 && y < grid.count_y; ++y) {
        for (std::uint32_t x = cx == 0 ? 0 : cx - 1; x <= cx + 1 && x < grid.count_x; ++x) {
          for (std::uint32_t j = grid.heads[grid.index(x, y, z)]; j != kNoBall; j = grid.next[j]) {
            if (j >= i || before[j] == Verdict::rejected) continue;
            const Candidate other = grid.candidates[j];
            const double span = me.value + other.value + grid.gap;
            if (length_squared(me.point - other.point) >= span * span) continue;
            if (before[j] == Verdict::accepted) {
              after[i] = Verdict::rejected;
              return;
            }
            blocked = true;
          }
        }
      }
    }
    if (!blocked) after[i] = Verdict::accepted;
  }
};

struct FlagAccepted {
  View<const Verdict> verdicts;
  View<std::uint32_t> flags;
  AERATE_HD void operator()(std::size_t i) const { flags[i] = verdicts[i] == Verdict::accepted ? 1 : 0; }
};

struct PlaceAccepted {
  View<const Candidate> candidates;
  View<const std::uint32_t> flags;
  View<const std::uint32_t> offsets;
  std::size_t first;
  std::size_t most;
  View<Ball> balls;

  AERATE_HD void operator()(std::size_t i) const {
    if (flags[i] != 0 && offsets[i] < most) {
      balls[first + offsets[i]] = {candidates[i].point, candidates[i].value};
    }
  }
};

}  // namespace selection_detail

template <typename Executor>
class CandidateSelection {
 public:
  CandidateSelection(const Executor& executor, Paced<Executor>& paced) : executor_(executor), paced_(paced) {}

  // For candidates in the box with values up to `largest`.
  void reset(const Box3d& box, double largest, double gap, double least_cell) {
    const Vec3d size = box.upper - box.lower;
    const double cell = max_of(2 * largest + gap, least_cell) * 1.000001;
    grid_.origin = box.lower;
    grid_.cells_per_mm = 1 / cell;
    grid_.count_x = static_cast<std::uint32_t>(size.x / cell) + 1;
    grid_.count_y = static_cast<std::uint32_t>(size.y / cell) + 1;
    grid_.count_z = static_cast<std::uint32_t>(size.z / cell) + 1;
    grid_.gap = gap;
    const std::size_t cells = std::size_t{grid_.count_x} * grid_.count_y * grid_.count_z;
    if (heads_.size() < cells) heads_ = executor_.template allocate<std::uint32_t>(cells);
    grid_.heads = {heads_.view().data, cells};
    executor_.for_each_index(cells, SetAll<std::uint32_t>{grid_.heads, kNoBall});
  }

  // Appends balls, at most `most`, for those of the listed candidates that meet no larger one. Of candidates
  // alike the first in the list wins.
  void place(View<const Candidate> candidates, View<const std::uint32_t> list, std::size_t most,
             GrowingBuffer<Executor, Ball>& balls) {
    using namespace selection_detail;
    const std::size_t count = list.size;
    rank(candidates, list);
    decide(count);
    flags_.resize(executor_, count);
    scan_.resize(executor_, count);
    executor_.for_each_index(count, FlagAccepted{verdicts_.view(), flags_.view()});
    const std::size_t accepted =
        std::min<std::size_t>(executor_.exclusive_scan(flags_.view(), scan_.view()), most);
    const std::size_t first = balls.size();
    balls.resize(executor_, first + accepted);
    executor_.for_each_index(
        count, PlaceAccepted{ranked_.view(), flags_.view(), scan_.view(), first, accepted, balls.view()});
  }

 private:
  // Leaves the listed candidates in `ranked_`, the largest first.
  void rank(View<const Candidate> candidates, View<const std::uint32_t> list) {
    using namespace selection_detail;
    keys_.resize(executor_, list.size);
    order_.resize(executor_, list.size);
    executor_.for_each_index(list.size, RankKeys{candidates, list, keys_.view(), order_.view()});
    executor_.sort_pairs(keys_.view(), order_.view());
    ranked_.resize(executor_, list.size);
    executor_.for_each_index(list.size, Gather{candidates, order_.view(), ranked_.view()});
  }

  // Leaves the verdicts on the ranked candidates in `verdicts_`. A chain of candidates that wait for each
  // other may stay undecided: those get their turn in the next round.
  void decide(std::size_t count) {
    using namespace selection_detail;
    next_.resize(executor_, count);
    verdicts_.resize(executor_, count);
    new_verdicts_.resize(executor_, count);
    grid_.candidates = ranked_.view();
    grid_.next = next_.view();
    executor_.for_each_index(count, LinkCandidates{grid_});
    executor_.for_each_index(count, SetAll<Verdict>{verdicts_.view(), Verdict::undecided});
    constexpr int kPasses = 4;
    for (int pass = 0; pass < kPasses; ++pass) {
      paced_.for_each_index(count, Decide{grid_, verdicts_.view(), new_verdicts_.view()});
      std::swap(verdicts_, new_verdicts_);
    }
    executor_.for_each_index(count, UnlinkCandidates{grid_});
  }

  const Executor& executor_;
  Paced<Executor>& paced_;
  selection_detail::CandidateGrid grid_;
  typename Executor::template Buffer<std::uint32_t> heads_;
  GrowingBuffer<Executor, std::uint64_t> keys_;
  GrowingBuffer<Executor, std::uint32_t> order_, next_, flags_, scan_;
  GrowingBuffer<Executor, Candidate> ranked_;
  GrowingBuffer<Executor, selection_detail::Verdict> verdicts_, new_verdicts_;
};

}  // namespace aerate::kernels
