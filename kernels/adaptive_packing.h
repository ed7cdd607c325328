#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "kernels/adaptive_cells.h"
#include "kernels/adaptive_field.h"
#include "kernels/adaptive_idle.h"
#include "kernels/adaptive_lattice.h"
#include "kernels/adaptive_refine.h"
#include "kernels/adaptive_selection.h"
#include "kernels/adaptive_settle.h"
#include "kernels/ball_grid.h"
#include "kernels/constants.h"
#include "kernels/cuda_device.h"
#include "kernels/growing_buffer.h"
#include "kernels/paced.h"
#include "kernels/packed_shape.h"
#include "kernels/packer.h"
#include "kernels/roof.h"
#include "kernels/tally.h"
#include "kernels/triangle_bvh.h"
#include "kernels/vec.h"
#include "kernels/view.h"
#include "kernels/winding.h"

// The adaptive packing as one template over the executor (docs/packing.md says how it works and why).

namespace aerate::kernels {

// What a packing must obey, mm, and when it ends.
struct AdaptiveParameters {
  double wall = 0;
  double gap = 0;
  double min_radius = 0;
  double max_radius = kInfinity;
  std::size_t max_count = std::numeric_limits<std::size_t>::max();
  double max_volume = kInfinity;  // mm3, of all voids
  Roof roof{};
  bool in_level_squares = false;  // see PackingLimits
};

struct AdaptiveInput : PackerInput {
  double volume = 0;  // mm3, of the solid
  AdaptiveParameters parameters{};
  // Packs in the ways of `kBestAttempts` as well, and keeps the most volume.
  bool searches_more = false;
  // Cells, searches and places that are worked on at a time; fewer if memory asks for it, or where fewer keep
  // the executor busy. The result does not depend on it.
  std::size_t most_at_a_time = std::size_t{1} << 20;
};

struct AdaptiveResult {
  std::vector<Ball> balls;        // in the order they were placed
  std::size_t lattice_count = 0;  // so many of the first stand on a lattice
  std::size_t search_count = 0;   // searches for a local maximum, of all attempts
  std::size_t index_bytes = 0;
  std::size_t most_at_a_time = 0;
};

namespace adaptive_detail {

template <typename Shape>
struct Search {
  CellsView cells;
  FieldView<Shape> field;
  View<const std::uint32_t> list;
  RefineLimits limits;
  double shrink;  // taken off every radius, against rounding
  View<Candidate> candidates;
  View<std::uint8_t> found;

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

// Appends what was found, ready to be ranked: by value, and what settles by how far along the pull it is.
struct ListFound {
  View<const Candidate> searched;
  View<const std::uint8_t> found;
  std::size_t first;
  bool settles;
  Vec3d pull;
  View<Candidate> candidates;
  View<std::uint64_t> keys;
  View<std::uint32_t> order;

  AERATE_HD void operator()(std::size_t i, Tally before) const {
    if (found[i] == 0) return;
    const std::size_t to = first + before.first;
    candidates[to] = searched[i];
    keys[to] = rank_key(settles ? dot(searched[i].point, pull) : searched[i].value);
    order[to] = static_cast<std::uint32_t>(to);
  }
};

// How many elements may be worked on at a time: the largest buffers of those hold 160 bytes for each, and are
// to take no more than a quarter of the memory.
inline std::size_t elements_at_a_time(std::size_t free_bytes, std::size_t most) {
  constexpr std::size_t kBytes = 160, kLeast = 512;
  return max_of(min_of(free_bytes / 4 / kBytes, most), kLeast);
}

// One way to pack.
struct Attempt {
  double share_of_largest = kInfinity;  // the largest radius, to that of the largest ball that fits
  double first_cell = 2.2;  // half diagonal of the first balls' cells, to the level's least radius
};

// The largest ball that fits is not always in the densest packing, and finer cells miss fewer places
// (docs/packing.md has what each brings).
constexpr std::array<Attempt, 5> kBestAttempts{
    {{kInfinity, 1.0}, {0.95, 1.0}, {0.925, 1.0}, {0.9, 1.0}, {0.875, 1.0}}};

// What distances to the model and winding numbers are asked of. The winding numbers' index is made of the
// hierarchy's own facets, so that they are in memory once.
template <typename Executor>
struct AdaptiveIndex {
  TriangleBvh<Executor> bvh;
  WindingIndex<Executor> winding;

  AdaptiveIndex(const Executor& executor, const AdaptiveInput& input) {
    {
      const auto facets = gather_facets(executor, input.positions, input.triangles);
      input.progress(0);
      bvh = build_triangle_bvh(executor, facets.view(), input.box);
    }
    input.progress(0);
    winding = build_winding_index(executor, bvh.view.facets, input.box);
    input.progress(0);
  }

  std::size_t bytes() const { return bvh.bytes() + winding.cells.bytes(); }
};

}  // namespace adaptive_detail

// One packing.
template <typename Executor, typename Shape>
class AdaptivePacker {
 public:
  // The executor, the index and the input stay with the caller.
  //   first_cell: see adaptive_detail::Attempt
  AdaptivePacker(const Executor& executor, const adaptive_detail::AdaptiveIndex<Executor>& index,
                 const AdaptiveInput& input, const Shape& shape, double first_cell)
      : executor_(executor),
        index_(index),
        paced_(executor, [this, &input] { input.progress(share_done()); }),
        parameters_(input.parameters),
        box_(input.box),
        solid_volume_(input.volume),
        first_cell_(first_cell),
        shape_(shape),
        grid_(executor, shape),
        tree_(executor, paced_),
        idle_(executor),
        selection_(executor, paced_, shape) {
    // More than keep all threads busy take memory for nothing.
    const std::size_t most = min_of(input.most_at_a_time, 8 * Executor::kLeastPiece);
    at_a_time_ = adaptive_detail::elements_at_a_time(executor_.free_bytes(), most);
    const Vec3d size = box_.upper - box_.lower;
    const double longest = max_of(size.x, max_of(size.y, size.z));
    shrink_ = longest * 1e-13 + (std::abs(box_.lower.x) + std::abs(box_.lower.y) + std::abs(box_.lower.z) +
                                 std::abs(box_.upper.x) + std::abs(box_.upper.y) + std::abs(box_.upper.z)) *
                                    1e-14;
  }

  AdaptivePacker(const AdaptivePacker&) = delete;
  AdaptivePacker& operator=(const AdaptivePacker&) = delete;

  AdaptiveResult pack() {
    place_all();
    return {executor_.download(balls_.view()), lattice_count_, search_count_, index_.bytes(), at_a_time_};
  }

 private:
  static constexpr double kTrifle = 1e-9;     // of a radius
  static constexpr double kLevelRatio = 0.9;  // balls of a level are at least this much of its largest
  // The grid of balls is made anew when the largest clearance left is this much of its reach: long lists cost
  // more than new ones.
  static constexpr double kRebuildRatio = 0.75;
  static constexpr double kSphereVolume = 4.18879020478639098;  // 4/3 pi

  void place_all() {
    const Vec3d size = box_.upper - box_.lower;
    const double half_extent = 0.5 * min_of(size.x, min_of(size.y, size.z));
    double largest = min_of(half_extent, parameters_.max_radius);
    least_radius_ = least_radius(largest);
    place_lattice(half_extent, 0.5 * middle_of(size));
    if (done_) return;
    tree_.make_roots(field(), box_, at_a_time_);
    rebuild_grids(largest);
    grid_.enter(balls_.view(), 0, parameters_.max_radius);
    if (parameters_.max_radius < half_extent) settle_largest();
    if (done_) return;
    threshold_ = parameters_.max_radius < half_extent ? largest - 4 * shrink_ : largest * kLevelRatio;
    while (true) {
      if (threshold_ < least_radius_) threshold_ = least_radius_;
      if (largest < kRebuildRatio * grid_.reach()) rebuild_grids(largest);
      while (place_round()) {
        if (done_) return;
      }
      if (threshold_ <= least_radius_ || threshold_ < 1e-7 * half_extent) break;
      largest = threshold_;
      threshold_ *= kLevelRatio;
    }
  }

  static double middle_of(Vec3d size) {
    return max_of(min_of(size.x, size.y), min_of(max_of(size.x, size.y), size.z));
  }

  // The least radius, or where it is that of the largest ball a trifle less, as for a lattice: what is taken
  // off against rounding would leave no ball at all.
  double least_radius(double largest) const {
    if (parameters_.min_radius > largest) return parameters_.min_radius;
    return min_of(parameters_.min_radius, largest - max_of(kTrifle * largest, 4 * shrink_));
  }

  // Balls of the largest radius where they rest on others. What floats, or the last few that trickle in one
  // by one, is left to the rounds that follow.
  void settle_largest() {
    constexpr std::size_t kFewest = 200;  // of those that stand, a round adds at least one for so many
    Settling settling{parameters_.max_radius};
    const double spare = (parameters_.max_radius - shrink_ - least_radius_) / parameters_.max_radius;
    settling.tolerance = min_of(settling.tolerance, 0.5 * spare);
    threshold_ = settling.least();
    // Balls that are placed stop what is pulled past them; ways are straight to about half a radius.
    const double touching = shape_.span(2 * settling.radius + parameters_.gap, settling.radius);
    idle_.reset(box_, touching + 0.5 * settling.radius, grid_.least_cell(box_), balls_.size());
    std::size_t before = 0;
    do {
      before = balls_.size();
      if (!place_round(&settling)) return;
    } while (!done_ && balls_.size() > before + before / kFewest);
  }

  // A guess: by count or volume where they are limited, else by the radius reached.
  double share_done() const {
    double done = 0;
    const auto count = static_cast<double>(balls_.size());
    if (parameters_.max_count < std::numeric_limits<std::size_t>::max()) {
      done = count / static_cast<double>(parameters_.max_count);
    }
    done = max_of(done, volume_ / parameters_.max_volume);
    if (parameters_.min_radius > 0 && threshold_ > 0) {
      const double ratio = parameters_.min_radius / threshold_;
      done = max_of(done, ratio * ratio);  // most of the work is in the small ones
    }
    return min_of(done, 1.0);
  }

  // Cells that are searched: their half diagonal to the level's least radius, and how far a search goes, in
  // extents of its cell.
  struct Fineness {
    double cell, region;
  };
  // The first balls are most of the volume and little of the work, so they get finer cells. For those that
  // settle: more starts, better places.
  Fineness fineness(const Settling* settling) const {
    constexpr std::size_t kFirst = 5000;
    constexpr double kCellOfSettling = 1.4;
    const Fineness usual = balls_.size() < kFirst ? Fineness{first_cell_, 1.0} : Fineness{2.8, 0.8};
    return settling != nullptr ? Fineness{kCellOfSettling, usual.region} : usual;
  }

  FieldView<Shape> field() { return {index_.bvh.view, index_.winding.view, grid_.view(), parameters_.wall}; }

  // Starts from the densest lattice of balls of max_radius where that is small against the model in two
  // directions at least, in the best of several orientations and offsets; `Lattice` says which there are. In
  // slender models a lattice fits badly whatever its offset, and balls that settle are denser. In a slab it
  // has to leave little room for what is between the radii, or they have to be alike. There is none for voids
  // that are no balls. Level squares are asked for: they stand however few they are.
  void place_lattice(double half_thickness, double half_middle) {
    constexpr double kDiameters = 3, kAlike = 0.95;
    constexpr double kLeastShare = 0.25, kLeastShareOfSlab = 0.5;  // of the volume, half the gap included
    constexpr std::uint32_t kTrials = 16;
    const double least_half = parameters_.max_radius * kDiameters;
    const bool is_asked_for = parameters_.in_level_squares && up_axis() != kNone;
    if (!Shape::kIsBall || (!is_asked_for && !(least_half < half_middle))) return;
    const bool fills_by_itself =
        least_half < half_thickness || parameters_.min_radius >= kAlike * parameters_.max_radius;
    const double least_share = fills_by_itself ? kLeastShare : kLeastShareOfSlab;
    // A trifle smaller, so that ten balls fit where ten diameters are the length of a box.
    const double radius = parameters_.max_radius * (1 - kTrifle);
    const LatticeFit fit{index_.bvh.view, index_.winding.view, radius + parameters_.wall + shrink_};
    Lattice best;
    std::size_t best_count = 0;
    for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
      const double apart = radius + 0.5 * parameters_.gap + shrink_;
      const double inset = radius + parameters_.wall + 2 * shrink_;
      const Lattice lattice = is_asked_for
                                  ? make_lattice(box_, apart, inset, Stacking::square, up_axis(), trial)
                                  : make_lattice(box_, apart, inset, trial);
      const std::size_t count = count_fitting(fit, lattice);
      if (count <= best_count) continue;
      best = lattice;
      best_count = count;
    }
    if (best_count == 0 || (!is_asked_for && lattice_share(best_count) < least_share)) return;
    best_count = std::min(best_count, parameters_.max_count);
    lattice_count_ = best_count;
    balls_.resize(executor_, best_count);
    std::size_t placed = 0;
    for_each_fit(fit, best, [&](std::size_t first, View<const std::uint8_t> fits) {
      const PlaceLattice place{best, first, fits, radius, balls_.view_from(placed)};
      const Tally total = executor_.select(fits.size, TallyMarked{fits}, place);
      placed = std::min(placed + total.first, best_count);
    });
    stop_at_limits(0);
  }

  // Of the model's axes the one that `roof.up` lies along, or kNone.
  std::uint32_t up_axis() const {
    const Vec3d up = parameters_.roof.up;
    if (std::abs(up.x) == 1) return 0;
    if (std::abs(up.y) == 1) return 1;
    return std::abs(up.z) == 1 ? 2 : kNone;
  }

  double lattice_share(std::size_t count) const {
    const double radius = parameters_.max_radius + 0.5 * parameters_.gap;
    return static_cast<double>(count) * kSphereVolume * radius * radius * radius / solid_volume_;
  }

  std::size_t count_fitting(const LatticeFit& fit, const Lattice& lattice) {
    std::size_t count = 0;
    for_each_fit(fit, lattice, [&](std::size_t, View<const std::uint8_t> fits) {
      count += executor_.select(fits.size, TallyMarked{fits}, CountOnly{}).first;
    });
    return count;
  }

  // Calls piece(first, fits) for the lattice's places in pieces.
  template <typename Piece>
  void for_each_fit(LatticeFit fit, const Lattice& lattice, Piece piece) {
    fit.lattice = lattice;
    for_each_piece(lattice.size(), at_a_time_, [&](std::size_t first, std::size_t count) {
      found_.resize(executor_, count);
      fit.first = first;
      fit.fits = found_.view();
      paced_.for_each_index(count, fit);
      piece(first, found_.view());
    });
  }

  // Grids for clearances up to `reach`, with all balls placed so far.
  void rebuild_grids(double reach) {
    grid_.reset(box_, reach, parameters_.gap, at_a_time_);
    // A trifle more than the gap, since two that are accepted together may touch.
    selection_.reset(box_, reach, parameters_.gap + shrink_, grid_.least_cell(box_));
  }

  // One round: false if nothing of at least the threshold was placed. `settling`, if any: where balls are
  // pulled.
  bool place_round(const Settling* settling = nullptr) {
    using namespace adaptive_detail;
    View<const std::uint32_t> cells =
        tree_.refine(field(), threshold_, fineness(settling).cell * threshold_, max_of(least_radius_, 0.0));
    if (settling != nullptr) cells = idle_.awake(tree_.view(), cells, tree_.tidied(), balls_);
    if (cells.size == 0) return false;
    search_count_ += cells.size;
    search(cells, settling);
    if (candidates_.size() == 0) return false;
    const std::size_t first = balls_.size();
    selection_.place(candidates_.view(), keys_.view(), order_.view(), parameters_.max_count - first, balls_);
    stop_at_limits(first);
    if (done_) return true;
    ball_order_.order(executor_, box_, balls_.view_from(first));
    grid_.enter(balls_.view(), first, grid_.reach());
    return true;
  }

  // Leaves what is found in these cells in `candidates_`, with keys and order for ranking.
  void search(View<const std::uint32_t> cells, const Settling* settling) {
    using namespace adaptive_detail;
    constexpr double kPrecision = 1e-4;  // of the maxima, to the level's least radius
    const RefineLimits limits{threshold_ + shrink_, grid_.reach(), kPrecision * threshold_,
                              fineness(settling).region};
    std::size_t found = 0;
    for_each_piece(cells.size, at_a_time_, [&](std::size_t first, std::size_t count) {
      const View<const std::uint32_t> list{cells.data + first, count};
      searched_.resize(executor_, list.size);
      found_.resize(executor_, list.size);
      resize_candidates(found + list.size);
      paced_.for_each_index(list.size, Search<Shape>{tree_.view(), field(), list, limits, shrink_,
                                                     searched_.view(), found_.view()});
      if (settling != nullptr) {
        paced_.for_each_index(list.size, Settle<Shape>{tree_.view(), list, field(), *settling, shrink_,
                                                       searched_.view(), found_.view(), idle_.paths()});
      }
      const ListFound append{searched_.view(),
                             found_.view(),
                             found,
                             settling != nullptr,
                             settling != nullptr ? settling->pull : Vec3d{0, 0, 0},
                             candidates_.view(),
                             keys_.view(),
                             order_.view()};
      found += executor_.select(list.size, TallyMarked{found_.view()}, append).first;
    });
    resize_candidates(found);
  }

  void resize_candidates(std::size_t count) {
    candidates_.resize(executor_, count);
    keys_.resize(executor_, count);
    order_.resize(executor_, count);
  }

  // Looks at the balls from `first` on; takes back those beyond the wanted volume.
  void stop_at_limits(std::size_t first) {
    if (balls_.size() >= parameters_.max_count) done_ = true;
    if (!(parameters_.max_volume < kInfinity)) return;
    std::size_t count = first;
    for (const Ball& ball :
         executor_.download(View<Ball>{balls_.view().data + first, balls_.size() - first})) {
      volume_ += shape_.volume(ball.radius);
      ++count;
      if (volume_ < parameters_.max_volume) continue;
      done_ = true;
      balls_.resize(executor_, count);
      return;
    }
  }

  const Executor& executor_;
  const adaptive_detail::AdaptiveIndex<Executor>& index_;
  Paced<Executor> paced_;
  AdaptiveParameters parameters_;
  Box3d box_;
  double solid_volume_;
  double first_cell_;
  Shape shape_;
  double shrink_ = 0;
  double threshold_ = 0;
  double least_radius_ = 0;
  double volume_ = 0;
  bool done_ = false;
  std::size_t at_a_time_ = 0;
  std::size_t search_count_ = 0, lattice_count_ = 0;

  BallGrid<Executor, Shape> grid_;
  BallOrder<Executor> ball_order_;
  CellTree<Executor, Shape> tree_;
  IdleCells<Executor> idle_;
  CandidateSelection<Executor, Shape> selection_;
  GrowingBuffer<Executor, Ball> balls_;
  GrowingBuffer<Executor, Candidate> searched_, candidates_;
  GrowingBuffer<Executor, std::uint8_t> found_;
  GrowingBuffer<Executor, std::uint64_t> keys_;
  GrowingBuffer<Executor, std::uint32_t> order_;
};

namespace adaptive_detail {

// Throws CudaError (out_of_memory) unless the index of the triangles fits into the memory that is free.
inline void require_room_for_index(std::size_t triangles, std::size_t free_bytes) {
  // What it needs while it is built, about, for each facet: the facets twice, in the mesh's order and in the
  // hierarchy's, their boxes, and keys and order with a second copy to sort them.
  constexpr std::size_t kBytes = 2 * sizeof(Facet) + sizeof(Box3f) + 12;
  constexpr std::size_t kBeside = 1 << 16;
  const std::size_t needed = triangles * kBytes + kBeside;
  if (free_bytes >= needed) return;
  throw CudaError(CudaError::Kind::out_of_memory,
                  "the index of " + std::to_string(triangles) + " triangles needs about " +
                      std::to_string(needed >> 10) + " KiB of device memory, and " +
                      std::to_string(free_bytes >> 10) + " KiB are free",
                  kTooLittleMemoryHint);
}

}  // namespace adaptive_detail

// The whole job. The triangles go to the executor's memory once, and each ball comes back once. What is
// worked on at a time follows the free memory; the index, the cells and the balls must fit.
template <typename Shape = BallShape>
struct AdaptivePacking {
  using Input = AdaptiveInput;
  using Result = AdaptiveResult;

  template <typename Executor>
  static AdaptiveResult pack(const Executor& executor, const AdaptiveInput& input) {
    using namespace adaptive_detail;
    require_room_for_index(input.triangles.size(), executor.free_bytes());
    const AdaptiveIndex<Executor> index(executor, input);
    const std::size_t attempts = 1 + (input.searches_more ? kBestAttempts.size() : 0);
    AdaptiveResult best = attempt(executor, index, part_of(input, 0, attempts), Attempt{});
    if (!input.searches_more || best.balls.empty()) return best;
    const double largest = largest_of(best.balls);
    double most = volume_of(best.balls, input);
    for (std::size_t k = 0; k < kBestAttempts.size(); ++k) {
      AdaptiveInput part = part_of(input, k + 1, attempts);
      double& max_radius = part.parameters.max_radius;
      max_radius = min_of(max_radius, kBestAttempts[k].share_of_largest * largest);
      // A density that is wanted is reached with the fewest balls by the largest.
      if (max_radius < input.parameters.min_radius || most >= input.parameters.max_volume) break;
      AdaptiveResult other = attempt(executor, index, part, kBestAttempts[k]);
      other.search_count += best.search_count;
      const double volume = volume_of(other.balls, input);
      if (volume > most) {
        best = std::move(other);
        most = volume;
      } else {
        best.search_count = other.search_count;
      }
    }
    return best;
  }

 private:
  template <typename Executor>
  static AdaptiveResult attempt(const Executor& executor,
                                const adaptive_detail::AdaptiveIndex<Executor>& index,
                                const AdaptiveInput& input, const adaptive_detail::Attempt& way) {
    const Shape shape = Shape::under(input.parameters.roof);
    return AdaptivePacker<Executor, Shape>(executor, index, input, shape, way.first_cell).pack();
  }

  // The input for one of several attempts, which is a part of what is to be done.
  static AdaptiveInput part_of(const AdaptiveInput& input, std::size_t k, std::size_t attempts) {
    AdaptiveInput part = input;
    part.progress = [progress = input.progress, k, attempts](double done) {
      progress((static_cast<double>(k) + done) / static_cast<double>(attempts));
    };
    return part;
  }

  static double largest_of(const std::vector<Ball>& balls) {
    double largest = 0;
    for (const Ball& ball : balls) largest = max_of(largest, ball.radius);
    return largest;
  }

  static double volume_of(const std::vector<Ball>& balls, const AdaptiveInput& input) {
    const Shape shape = Shape::under(input.parameters.roof);
    double volume = 0;
    for (const Ball& ball : balls) volume += shape.volume(ball.radius);
    return volume;
  }
};

}  // namespace aerate::kernels
