#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "kernels/adaptive_field.h"
#include "kernels/adaptive_lattice.h"
#include "kernels/adaptive_refine.h"
#include "kernels/growing_buffer.h"
#include "kernels/triangle_bvh.h"
#include "kernels/vec.h"
#include "kernels/view.h"
#include "kernels/winding.h"

// The adaptive packing as one template over the executor (docs/packing.md says how it works and why).

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

namespace adaptive_detail {

constexpr double kHalfDiagonalOfEdge = 0.86602540378443865;  // sqrt(3)/2

struct FlagReaching {
  View<const double> bounds;
  double threshold;
  View<std::uint32_t> flags;

  AERATE_HD void operator()(std::size_t i) const { flags[i] = bounds[i] >= threshold ? 1 : 0; }
};

struct Compact {
  View<const std::uint32_t> flags;
  View<const std::uint32_t> offsets;
  View<std::uint32_t> list;

  AERATE_HD void operator()(std::size_t i) const {
    if (flags[i] != 0) list[offsets[i]] = static_cast<std::uint32_t>(i);
  }
};

struct GatherIds {
  View<const std::uint32_t> from;
  View<const std::uint32_t> list;
  View<std::uint32_t> to;
  AERATE_HD void operator()(std::size_t i) const { to[i] = from[list[i]]; }
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

struct Candidate {
  Vec3d point;
  double value;
};

struct Search {
  CellsView cells;
  FieldView field;
  View<const std::uint32_t> list;
  RefineLimits limits;
  double shrink;  // taken off every radius, against rounding
  View<Candidate> candidates;
  View<std::uint32_t> found;

  AERATE_HD void operator()(std::size_t i) const {
    const std::uint32_t id = list[i];
    const Cell cell = cells.cells[id];
    const LocalMaximum maximum = find_local_maximum(field, cell.anchor(), cells.half_diagonal(id), limits);
    found[i] = maximum.value >= limits.least ? 1 : 0;
    if (found[i] != 0) {
      candidates[i] = {maximum.point, maximum.value - shrink};
      cells.bounds[id] = maximum.value;
    } else {
      // Asleep until the threshold falls; at most until the next level.
      cells.bounds[id] = min_of(maximum.bound, 0.9999 * limits.least);
    }
  }
};

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

}  // namespace adaptive_detail

// What a packing must obey and when it ends; and how it is done, for benchmarks that show why.
struct AdaptiveParameters {
  double wall = 0;
  double gap = 0;
  double min_radius = 0;
  double max_radius = kUnbounded;
  std::size_t max_count = std::numeric_limits<std::size_t>::max();
  double max_volume = kUnbounded;  // mm3, of all balls
  double level_ratio = 0.9;        // balls of a level are at least this much of its largest
  double cell_ratio = 1.4;         // half diagonal of searched cells to the level's least radius
  double region_ratio = 1.25;
  std::uint32_t lattice_trials = 16;
  double tolerance_ratio = 1e-4;  // precision of the maxima to the level's least radius
};

struct AdaptiveInput {
  std::span<const Vec3f> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;
  Box3d box{};  // of the positions
  AdaptiveParameters parameters;
  // Called between pieces of work with the share that is done; what it throws ends the job.
  std::function<void(double)> progress = [](double) {};
};

struct AdaptiveResult {
  std::vector<Ball> balls;        // in the order they were placed
  std::size_t lattice_count = 0;  // so many of the first stand on a lattice
  std::size_t search_count = 0;   // searches for a local maximum
  std::size_t round_count = 0;
  std::size_t index_bytes = 0;
};

template <typename Executor>
class AdaptivePacker {
 public:
  template <typename T>
  using Buffer = typename Executor::template Buffer<T>;

  // facets: of a closed mesh, in the executor's memory, inside `box`.
  AdaptivePacker(const Executor& executor, View<const Facet> facets, const Box3d& box,
                 const AdaptiveParameters& parameters)
      : executor_(executor), parameters_(parameters), box_(box) {
    bvh_ = build_triangle_bvh(executor_, facets, box);
    winding_ = build_winding_index(executor_, facets, box);
    const Vec3d size = box.upper - box.lower;
    const double longest = max_of(size.x, max_of(size.y, size.z));
    shrink_ = longest * 1e-13 + (std::abs(box.lower.x) + std::abs(box.lower.y) + std::abs(box.lower.z) +
                                 std::abs(box.upper.x) + std::abs(box.upper.y) + std::abs(box.upper.z)) *
                                    1e-14;
  }

  AdaptiveResult pack(const std::function<void(double)>& tick) {
    place_all(tick);
    return {executor_.download(balls_.view()), lattice_count_, search_count_, round_count_,
            bvh_.bytes() + winding_.bytes()};
  }

 private:
  static constexpr double kLatticeDiameters = 3;

  void place_all(const std::function<void(double)>& tick) {
    const Vec3d size = box_.upper - box_.lower;
    const double half_extent = 0.5 * min_of(size.x, min_of(size.y, size.z));
    double largest = min_of(half_extent, parameters_.max_radius);
    place_lattice(half_extent);
    if (done_) return;
    make_roots();
    rebuild_grid(largest);
    double threshold =
        parameters_.max_radius < half_extent ? largest - 4 * shrink_ : largest * parameters_.level_ratio;
    while (true) {
      if (threshold < parameters_.min_radius) threshold = parameters_.min_radius;
      if (largest < 0.6 * reach_) rebuild_grid(largest);
      while (true) {
        tick(progress(threshold));
        if (!place_round(threshold)) break;
        if (done_) return;
      }
      if (threshold <= parameters_.min_radius || threshold < 1e-7 * half_extent) break;
      largest = threshold;
      threshold *= parameters_.level_ratio;
    }
  }

  // A guess: by count or volume where they are limited, else by the radius reached.
  double progress(double threshold) {
    double done = 0;
    const auto count = static_cast<double>(balls_.size());
    if (parameters_.max_count < std::numeric_limits<std::size_t>::max()) {
      done = count / static_cast<double>(parameters_.max_count);
    }
    done = max_of(done, volume_ / parameters_.max_volume);
    if (parameters_.min_radius > 0) {
      const double ratio = parameters_.min_radius / threshold;
      done = max_of(done, ratio * ratio);  // most of the work is in the small ones
    }
    return min_of(done, 1.0);
  }

  FieldView field() { return {bvh_.view, winding_.view, grid_, parameters_.wall}; }
  CellsView cells() { return {cells_.view(), bounds_.view(), root_half_diagonal_}; }

  void make_roots() {
    constexpr double kRootsAlongLongest = 12;
    const Vec3d size = box_.upper - box_.lower;
    const double edge = max_of(size.x, max_of(size.y, size.z)) / kRootsAlongLongest;
    const auto count = [&](double length) {
      return static_cast<std::uint32_t>(max_of(1.0, std::ceil(length / edge)));
    };
    const std::uint32_t nx = count(size.x), ny = count(size.y), nz = count(size.z);
    root_half_diagonal_ = edge * adaptive_detail::kHalfDiagonalOfEdge;
    resize_cells(std::size_t{nx} * ny * nz);
    executor_.for_each_index(cells_.size(),
                             adaptive_detail::MakeRoots{cells(), field(), box_.lower, edge, nx, ny});
  }

  // Starts from the densest lattice of balls of max_radius where that is small against the model, in the best
  // of several orientations and offsets; `Lattice` says which there are.
  void place_lattice(double half_extent) {
    if (!(parameters_.max_radius * kLatticeDiameters < half_extent)) return;
    const LatticeFit fit{bvh_.view, winding_.view, parameters_.max_radius + parameters_.wall + shrink_};
    Lattice best;
    std::size_t best_count = 0;
    for (std::uint32_t trial = 0; trial < parameters_.lattice_trials; ++trial) {
      const Lattice lattice = make_lattice(box_, parameters_.max_radius + 0.5 * parameters_.gap + shrink_,
                                           parameters_.max_radius + parameters_.wall, trial);
      const std::size_t count = fit_lattice(fit, lattice);
      if (count <= best_count) continue;
      best = lattice;
      best_count = count;
    }
    if (best_count == 0) return;
    fit_lattice(fit, best);
    best_count = std::min(best_count, parameters_.max_count);
    lattice_count_ = best_count;
    balls_.resize(executor_, best_count);
    executor_.for_each_index(found_.size(), PlaceLattice{best, found_.view(), scan_.view(),
                                                         parameters_.max_radius, best_count, balls_.view()});
    stop_at_limits(0);
  }

  std::size_t fit_lattice(LatticeFit fit, const Lattice& lattice) {
    fit.lattice = lattice;
    const std::size_t count = lattice.size();
    found_.resize(executor_, count);
    scan_.resize(executor_, count);
    fit.fits = found_.view();
    executor_.for_each_index(count, fit);
    return executor_.exclusive_scan(found_.view(), scan_.view());
  }

  void resize_cells(std::size_t count) {
    cells_.resize(executor_, count);
    bounds_.resize(executor_, count);
    flags_.resize(executor_, count);
    offsets_.resize(executor_, count);
  }

  // A grid for clearances up to `reach`, with all balls placed so far.
  void rebuild_grid(double reach) {
    constexpr double kMostCells = 1 << 25;
    const Vec3d size = box_.upper - box_.lower;
    double cell = reach * 1.0;
    cell = max_of(
        cell, std::cbrt(max_of(size.x, reach) * max_of(size.y, reach) * max_of(size.z, reach) / kMostCells));
    reach_ = reach;
    grid_.origin = box_.lower;
    grid_.cell = cell;
    grid_.cells_per_mm = 1 / cell;
    grid_.count_x = static_cast<std::uint32_t>(size.x / cell) + 1;
    grid_.count_y = static_cast<std::uint32_t>(size.y / cell) + 1;
    grid_.count_z = static_cast<std::uint32_t>(size.z / cell) + 1;
    grid_.reach = reach;
    grid_.gap = parameters_.gap;
    const std::size_t count = std::size_t{grid_.count_x} * grid_.count_y * grid_.count_z;
    if (heads_.size() < count) heads_ = executor_.template allocate<std::uint32_t>(count);
    grid_.heads = {heads_.view().data, count};
    executor_.for_each_index(count, SetAll<std::uint32_t>{grid_.heads, BallGridView::kEmpty});
    entries_.resize(executor_, 0);

    const double candidate_cell = max_of(2 * reach + parameters_.gap, cell) * 1.000001;
    candidate_grid_.origin = box_.lower;
    candidate_grid_.cells_per_mm = 1 / candidate_cell;
    candidate_grid_.count_x = static_cast<std::uint32_t>(size.x / candidate_cell) + 1;
    candidate_grid_.count_y = static_cast<std::uint32_t>(size.y / candidate_cell) + 1;
    candidate_grid_.count_z = static_cast<std::uint32_t>(size.z / candidate_cell) + 1;
    candidate_grid_.gap = parameters_.gap;
    const std::size_t candidate_cells =
        std::size_t{candidate_grid_.count_x} * candidate_grid_.count_y * candidate_grid_.count_z;
    if (candidate_heads_.size() < candidate_cells) {
      candidate_heads_ = executor_.template allocate<std::uint32_t>(candidate_cells);
    }
    candidate_grid_.heads = {candidate_heads_.view().data, candidate_cells};
    executor_.for_each_index(candidate_cells, SetAll<std::uint32_t>{candidate_grid_.heads, kNoBall});
    enter_balls(0);
  }

  void enter_balls(std::size_t first) {
    using namespace ball_grid_detail;
    const std::size_t count = balls_.size() - first;
    grid_.balls = balls_.view();
    if (count == 0) return;
    const auto first_ball = static_cast<std::uint32_t>(first);
    auto layers = executor_.template allocate<std::uint32_t>(count);
    auto layer_offsets = executor_.template allocate<std::uint32_t>(count);
    executor_.for_each_index(count, CountLayers{grid_, first_ball, layers.view()});
    const std::size_t total = executor_.exclusive_scan(layers.view(), layer_offsets.view());
    auto layer_ball = executor_.template allocate<std::uint32_t>(total);
    auto layer_index = executor_.template allocate<std::uint32_t>(total);
    executor_.for_each_index(
        count, ListLayers{layer_offsets.view(), layers.view(), layer_ball.view(), layer_index.view()});
    auto counts = executor_.template allocate<std::uint32_t>(total);
    auto offsets = executor_.template allocate<std::uint32_t>(total);
    executor_.for_each_index(total,
                             EnterLayer{grid_, first_ball, layer_ball.view(), layer_index.view(),
                                        EnterPass::mark_inside_and_count, counts.view(), offsets.view(), 0});
    const std::size_t added = executor_.exclusive_scan(counts.view(), offsets.view());
    const std::size_t before = entries_.size();
    entries_.resize(executor_, before + added);
    grid_.entries = entries_.view();
    executor_.for_each_index(
        total, EnterLayer{grid_, first_ball, layer_ball.view(), layer_index.view(), EnterPass::link,
                          counts.view(), offsets.view(), static_cast<std::uint32_t>(before)});
  }

  std::size_t list_flagged(View<std::uint32_t> flags, View<std::uint32_t> offsets,
                           GrowingBuffer<Executor, std::uint32_t>& list) {
    const std::size_t count = executor_.exclusive_scan(flags, offsets);
    list.resize(executor_, count);
    executor_.for_each_index(flags.size, adaptive_detail::Compact{flags, offsets, list.view()});
    return count;
  }

  // Leaves the cells to search in `search_`.
  std::size_t refine_cells(double threshold) {
    using namespace adaptive_detail;
    search_.resize(executor_, 0);
    while (true) {
      executor_.for_each_index(bounds_.size(), FlagReaching{bounds_.view(), threshold, flags_.view()});
      const std::size_t active = list_flagged(flags_.view(), offsets_.view(), active_);
      if (active == 0) return 0;
      split_.resize(executor_, active);
      wanted_.resize(executor_, active);
      scan_.resize(executor_, active);
      executor_.for_each_index(
          active, Examine{cells(), field(), active_.view(), threshold, parameters_.cell_ratio * threshold,
                          reach_, split_.view(), wanted_.view()});
      const std::size_t parents = list_flagged(split_.view(), scan_.view(), picked_);
      if (parents == 0) {
        const std::size_t searched = list_flagged(wanted_.view(), scan_.view(), picked_);
        search_.resize(executor_, searched);
        executor_.for_each_index(searched, GatherIds{active_.view(), picked_.view(), search_.view()});
        return searched;
      }
      search_.resize(executor_, parents);
      executor_.for_each_index(parents, GatherIds{active_.view(), picked_.view(), search_.view()});
      children_.resize(executor_, parents * 8);
      keep_.resize(executor_, parents * 8);
      scan_.resize(executor_, parents * 8);
      executor_.for_each_index(
          parents * 8, MakeChildren{cells(), field(), search_.view(), max_of(parameters_.min_radius, 0.0),
                                    reach_, children_.view(), keep_.view()});
      const std::size_t kept = executor_.exclusive_scan(keep_.view(), scan_.view());
      const std::size_t first = cells_.size();
      resize_cells(first + kept);
      executor_.for_each_index(parents * 8,
                               AppendChildren{children_.view(), keep_.view(), scan_.view(), cells(), first});
    }
  }

  // One round: false if nothing of at least `threshold` was placed.
  bool place_round(double threshold) {
    using namespace adaptive_detail;
    ++round_count_;
    const std::size_t searched = refine_cells(threshold);
    if (searched == 0) return false;
    search_count_ += searched;
    candidates_.resize(executor_, searched);
    found_.resize(executor_, searched);
    scan_.resize(executor_, searched);
    const RefineLimits limits{threshold + shrink_, reach_, parameters_.tolerance_ratio * threshold,
                              parameters_.region_ratio};
    executor_.for_each_index(searched, Search{cells(), field(), search_.view(), limits, shrink_,
                                              candidates_.view(), found_.view()});
    const std::size_t count = list_flagged(found_.view(), scan_.view(), picked_);
    if (count == 0) return false;

    keys_.resize(executor_, count);
    order_.resize(executor_, count);
    executor_.for_each_index(count,
                             RankKeys{candidates_.view(), picked_.view(), keys_.view(), order_.view()});
    executor_.sort_pairs(keys_.view(), order_.view());
    ranked_.resize(executor_, count);
    executor_.for_each_index(count, Gather{candidates_.view(), order_.view(), ranked_.view()});
    next_.resize(executor_, count);
    verdicts_.resize(executor_, count);
    new_verdicts_.resize(executor_, count);
    candidate_grid_.candidates = ranked_.view();
    candidate_grid_.next = next_.view();
    executor_.for_each_index(count, LinkCandidates{candidate_grid_});
    executor_.for_each_index(count, SetAll<Verdict>{verdicts_.view(), Verdict::undecided});
    constexpr int kPasses = 4;
    for (int pass = 0; pass < kPasses; ++pass) {
      executor_.for_each_index(count, Decide{candidate_grid_, verdicts_.view(), new_verdicts_.view()});
      std::swap(verdicts_, new_verdicts_);
    }
    executor_.for_each_index(count, UnlinkCandidates{candidate_grid_});

    found_.resize(executor_, count);
    scan_.resize(executor_, count);
    executor_.for_each_index(count, FlagAccepted{verdicts_.view(), found_.view()});
    std::size_t accepted = executor_.exclusive_scan(found_.view(), scan_.view());
    const std::size_t first = balls_.size();
    accepted = std::min(accepted, parameters_.max_count - first);
    balls_.resize(executor_, first + accepted);
    executor_.for_each_index(
        count, PlaceAccepted{ranked_.view(), found_.view(), scan_.view(), first, accepted, balls_.view()});
    enter_balls(first);
    stop_at_limits(first);
    return true;
  }

  // Looks at the balls from `first` on; takes back those beyond the wanted volume.
  void stop_at_limits(std::size_t first) {
    if (balls_.size() >= parameters_.max_count) done_ = true;
    if (!(parameters_.max_volume < kUnbounded)) return;
    constexpr double kSphereVolume = 4.18879020478639098;  // 4/3 pi
    std::size_t count = first;
    for (const Ball& ball :
         executor_.download(View<Ball>{balls_.view().data + first, balls_.size() - first})) {
      volume_ += kSphereVolume * ball.radius * ball.radius * ball.radius;
      ++count;
      if (volume_ < parameters_.max_volume) continue;
      done_ = true;
      balls_.resize(executor_, count);
      return;
    }
  }

  const Executor& executor_;
  AdaptiveParameters parameters_;
  Box3d box_;
  TriangleBvh<Executor> bvh_;
  WindingIndex<Executor> winding_;
  double shrink_ = 0;
  double root_half_diagonal_ = 0;
  double reach_ = 0;
  double volume_ = 0;
  bool done_ = false;
  std::size_t search_count_ = 0, round_count_ = 0, lattice_count_ = 0;

  BallGridView grid_;
  Buffer<std::uint32_t> heads_;
  adaptive_detail::CandidateGrid candidate_grid_;
  Buffer<std::uint32_t> candidate_heads_;

  GrowingBuffer<Executor, Ball> balls_;
  GrowingBuffer<Executor, BallEntry> entries_;
  GrowingBuffer<Executor, Cell> cells_;
  GrowingBuffer<Executor, double> bounds_;
  GrowingBuffer<Executor, std::uint32_t> flags_, offsets_, active_, split_, wanted_, scan_, picked_, search_,
      keep_, found_, order_, next_;
  GrowingBuffer<Executor, adaptive_detail::Child> children_;
  GrowingBuffer<Executor, adaptive_detail::Candidate> candidates_, ranked_;
  GrowingBuffer<Executor, std::uint64_t> keys_;
  GrowingBuffer<Executor, adaptive_detail::Verdict> verdicts_, new_verdicts_;
};

// The whole job. The triangles go to the executor's memory once, and each ball comes back once.
template <typename Executor>
AdaptiveResult pack_adaptive(const Executor& executor, const AdaptiveInput& input) {
  const auto facets = gather_facets(executor, input.positions, input.triangles);
  return AdaptivePacker<Executor>(executor, facets.view(), input.box, input.parameters).pack(input.progress);
}

}  // namespace aerate::kernels
