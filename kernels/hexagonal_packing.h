#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "kernels/atomic.h"
#include "kernels/facet_grid.h"
#include "kernels/hexagonal_lattice.h"
#include "kernels/packer.h"
#include "kernels/sphere.h"
#include "kernels/spheres_61.h"
#include "kernels/tally.h"
#include "kernels/winding.h"

// Hexagonal sphere packing after Cuba and Loaiza ("Parallel Sphere Packing for Arbitrary Domains") in its
// indexed form, as one template over the executor. docs/packing.md has the conventions and where they differ
// from the paper's (its medium spheres overlap their neighbours; these do not).

namespace aerate::kernels {

struct HexagonalParameters {
  double lattice_radius = 1;  // of the spheres that touch in the lattice: max_radius + gap / 2, mm
  double half_gap = 0;        // taken off every radius, mm
  double wall = 0;            // mm
  double min_radius = 0;      // mm
  double rounding_slack = 0;  // taken off every radius, so that rounded centres keep the gap, mm
};

inline constexpr std::uint32_t kReplacements = std::size(kCentresOf61InUnitSphere);

// What became of a candidate. The first is not a candidate at all: its centre is outside the bounding box.
enum class CandidateState : std::uint8_t {
  beyond_box,
  outside,
  overlapped_region,
  near_surface,
  below_min_radius,
  kept,
  kept_smaller,  // did not fit, where a sphere of the family's smaller radius does
};
inline constexpr std::size_t kCandidateStates = 7;

// The places of one kind of sphere. `smaller_radius` is tried where `radius` does not fit; 0 for none. A
// family whose radius is 0 is below the least radius: its places are counted, not tested.
struct CandidateFamily {
  HexagonalLattice lattice;
  SphereKind kind;
  double radius;
  double smaller_radius;
  View<const Vec3d> replacement_centres;  // in the unit sphere
  View<const std::uint32_t> replaced;     // lattice slots

  AERATE_HD Vec3d position(std::uint32_t slot) const {
    switch (kind) {
      case SphereKind::lattice:
        return lattice.lattice_position(slot);
      case SphereKind::interstice:
        return lattice.interstice_position(slot);
      case SphereKind::tetrahedral:
        return lattice.tetrahedral_position(slot);
      default:
        return lattice.lattice_position(replaced[slot / kReplacements]) +
               replacement_centres[slot % kReplacements] * lattice.radius;
    }
  }
};

namespace hexagonal_detail {

struct Classify {
  CandidateFamily family;
  std::uint32_t first_slot;
  WindingView winding;
  FacetGridView grid;
  double wall;
  View<CandidateState> states;

  AERATE_HD bool is_in_box(Vec3d c) const {
    const Box3d& box = winding.box;
    return c.x > box.lower.x && c.x < box.upper.x && c.y > box.lower.y && c.y < box.upper.y &&
           c.z > box.lower.z && c.z < box.upper.z;
  }

  AERATE_HD CandidateState classify(Vec3d centre) const {
    if (!is_in_box(centre)) return CandidateState::beyond_box;
    if (family.radius == 0) return CandidateState::below_min_radius;
    const int number = winding.winding_number(centre);
    if (number == 0) return CandidateState::outside;
    if (number != 1) return CandidateState::overlapped_region;
    if (!grid.any_facet_within(centre, family.radius + wall)) return CandidateState::kept;
    return family.smaller_radius > 0 && !grid.any_facet_within(centre, family.smaller_radius + wall)
               ? CandidateState::kept_smaller
               : CandidateState::near_surface;
  }

  AERATE_HD void operator()(std::size_t i) const {
    states[i] = classify(family.position(first_slot + static_cast<std::uint32_t>(i)));
  }
};

// Counts states. Each thread takes every 32nd of a block, so that neighbouring threads read neighbouring
// bytes, and few threads meet at a counter.
struct CountStates {
  static constexpr std::size_t kThreads = 32, kSteps = 128;
  View<const CandidateState> states;
  View<std::uint64_t> counters;

  AERATE_HD static std::size_t threads_for(std::size_t states) {
    return (states + kThreads * kSteps - 1) / (kThreads * kSteps) * kThreads;
  }

  AERATE_HD void operator()(std::size_t thread) const {
    // A byte for each state.
    static_assert(kSteps < 256 && kCandidateStates <= 8);
    std::uint64_t counts = 0;
    const std::size_t begin = thread / kThreads * kThreads * kSteps + thread % kThreads;
    const std::size_t end = min_of(begin + kThreads * kSteps, states.size);
    for (std::size_t i = begin; i < end; i += kThreads) {
      counts += std::uint64_t{1} << (8 * static_cast<unsigned>(states[i]));
    }
    for (std::size_t state = 0; state < kCandidateStates; ++state) {
      const std::uint64_t count = counts >> (8 * state) & 0xff;
      if (count != 0) atomic_add(counters[state], count);
    }
  }
};

AERATE_HD inline bool is_kept(CandidateState state) {
  return state == CandidateState::kept || state == CandidateState::kept_smaller;
}

// First list: what is kept; second: lattice spheres that met the surface.
struct TallyStates {
  View<const CandidateState> states;
  bool lists_met;

  AERATE_HD Tally operator()(std::size_t i) const {
    return {is_kept(states[i]) ? 1u : 0u, lists_met && states[i] == CandidateState::near_surface ? 1u : 0u,
            0u};
  }
};

struct Emit {
  View<const CandidateState> states;
  CandidateFamily family;
  std::uint32_t first_slot;
  bool lists_met;
  View<Sphere> spheres;
  View<std::uint32_t> met;

  AERATE_HD void operator()(std::size_t i, Tally before) const {
    const std::uint32_t slot = first_slot + static_cast<std::uint32_t>(i);
    if (is_kept(states[i])) {
      const bool smaller = states[i] == CandidateState::kept_smaller;
      spheres[before.first] = {family.position(slot), smaller ? family.smaller_radius : family.radius,
                               smaller ? SphereKind::interstice : family.kind};
    } else if (lists_met && states[i] == CandidateState::near_surface) {
      met[before.second] = slot;
    }
  }
};

}  // namespace hexagonal_detail

// Places that are worked on at a time: enough to fill any device, few enough for a caller that wants to know
// of progress.
inline constexpr std::size_t kMostSlots = std::size_t{1} << 20;

struct HexagonalInput : PackerInput {
  CellGrid grid{};  // for the facets
  HexagonalParameters parameters{};
  // At a time; fewer if memory asks for it. The result does not depend on it.
  std::size_t most_slots = kMostSlots;
};

struct HexagonalResult {
  std::vector<Sphere> spheres;  // lattice, interstices, tetrahedral, replacements; each in lattice order
  // By CandidateState, all kinds together. A lattice sphere that was replaced counts as near_surface, and so
  // does each of its 61 places that stayed empty for that reason.
  std::array<std::uint64_t, kCandidateStates> state_counts{};
  std::size_t index_bytes = 0, index_references = 0, index_cells = 0;  // of the largest strip
  std::size_t slots_at_a_time = 0;
  std::uint32_t strips = 0;  // of the model, each with an index of its own
};

// Memory that one place needs at most while it is worked on: its state, its sphere, and its entry in the list
// of replaced spheres.
inline constexpr std::size_t kBytesPerSlot = sizeof(CandidateState) + sizeof(Sphere) + sizeof(std::uint32_t);

// Spheres of one kind from consecutive places.
struct HexagonalPiece {
  std::uint32_t first_slot;  // of the lattice sphere that was replaced, for replacements
  std::vector<Sphere> spheres;
};

// What packers of parts of the lattice have found so far.
struct HexagonalPieces {
  std::array<std::vector<HexagonalPiece>, 4> by_kind;  // by SphereKind
  HexagonalResult result;                              // all but the spheres

  // In lattice order, in whatever order the parts were packed. Leaves nothing here.
  HexagonalResult joined() {
    std::size_t total = 0;
    for (const auto& pieces : by_kind)
      for (const HexagonalPiece& piece : pieces) total += piece.spheres.size();
    result.spheres.reserve(total);
    for (auto& pieces : by_kind) {
      std::stable_sort(pieces.begin(), pieces.end(), [](const HexagonalPiece& a, const HexagonalPiece& b) {
        return a.first_slot < b.first_slot;
      });
      for (HexagonalPiece& piece : pieces) {
        result.spheres.insert(result.spheres.end(), piece.spheres.begin(), piece.spheres.end());
        piece.spheres = {};
      }
      pieces.clear();
    }
    return std::move(result);
  }
};

// Rows of lattice cells along y.
struct LatticeRows {
  std::uint32_t first, last;
};

// Packs in slabs of places: all kinds of sphere, one after the other, and the replacements of a slab's
// lattice spheres at once.
template <typename Executor>
class HexagonalPacker {
 public:
  // winding, grid: may be made of the facets that matter to the rows' places alone
  HexagonalPacker(const Executor& executor, const WindingView& winding, const FacetGridView& grid,
                  const HexagonalInput& input, HexagonalPieces& pieces)
      : executor_(executor),
        winding_(winding),
        grid_(grid),
        input_(input),
        pieces_(pieces),
        lattice_(make_hexagonal_lattice(winding.box, input.parameters.lattice_radius)),
        centres_(executor.upload(std::span<const Vec3d>(kCentresOf61InUnitSphere))),
        slab_(slab_for(executor.free_bytes(), input.most_slots)),
        states_(executor.template allocate<CandidateState>(slab_)),
        spheres_(executor.template allocate<Sphere>(slab_)),
        met_(executor.template allocate<std::uint32_t>(slab_)),
        state_counters_(executor.template allocate<std::uint64_t>(kCandidateStates)) {
    pieces.result.slots_at_a_time = slab_;
  }

  // progress: called with the share of these rows that is done
  void pack(LatticeRows rows, const std::function<void(double)>& progress) {
    executor_.for_each_index(kCandidateStates, SetAll<std::uint64_t>{state_counters_.view(), 0});
    const double slots = static_cast<double>(lattice_.cell_count()) * (rows.last - rows.first) /
                         lattice_.count_y * (kLatticePerCell + kIntersticesPerCell + kTetrahedralPerCell);
    double done = 0;
    const auto tick = [&](std::size_t count) {
      done += static_cast<double>(count);
      progress(done / slots);
    };
    add_family(family_of(SphereKind::lattice, 1.0), kLatticePerCell, rows, tick);
    add_family(family_of(SphereKind::interstice, kInterstice), kIntersticesPerCell, rows, tick);
    CandidateFamily tetrahedral = family_of(SphereKind::tetrahedral, kTetrahedral);
    tetrahedral.smaller_radius = radius_of(kInterstice);
    add_family(tetrahedral, kTetrahedralPerCell, rows, tick);

    const std::vector<std::uint64_t> counts =
        executor_.download(View<const std::uint64_t>(state_counters_.view()));
    for (std::size_t i = 0; i < counts.size(); ++i) pieces_.result.state_counts[i] += counts[i];
  }

 private:
  template <typename T>
  using Buffer = typename Executor::template Buffer<T>;

  static constexpr std::size_t kLeastSlab = 1024;

  // A tenth of the memory is left for what allocators and sums need beside.
  static std::size_t slab_for(std::size_t free_bytes, std::size_t most_slots) {
    const std::size_t fitting = max_of(free_bytes / 10 * 9 / kBytesPerSlot, kLeastSlab);
    return max_of(min_of(fitting, most_slots), std::size_t{kReplacements});
  }

  // The radius of a family whose spheres have `relative` radius for lattice spheres of 1; 0 if that is below
  // the limit, which rounding must not decide where both are equal.
  double radius_of(double relative) const {
    const HexagonalParameters& p = input_.parameters;
    const double planned = relative * p.lattice_radius - p.half_gap;
    const double radius = planned - p.rounding_slack;
    return planned >= p.min_radius - p.rounding_slack && radius > 0 ? radius : 0.0;
  }

  CandidateFamily family_of(SphereKind kind, double relative) const {
    return {lattice_, kind, radius_of(relative), 0.0, centres_.view(), {}};
  }

  // The rows' places are one run of slots if they are all rows, else one in each layer.
  template <typename Tick>
  void add_family(const CandidateFamily& family, std::size_t slots_per_cell, LatticeRows rows, Tick tick) {
    const std::size_t row = lattice_.count_x * slots_per_cell;
    const bool is_whole = rows.first == 0 && rows.last == lattice_.count_y;
    const std::size_t runs = is_whole ? 1 : lattice_.count_z;
    const std::size_t rows_in_run =
        is_whole ? std::size_t{lattice_.count_y} * lattice_.count_z : rows.last - rows.first;
    for (std::size_t run = 0; run < runs; ++run) {
      const std::size_t begin = (run * lattice_.count_y + rows.first) * row;
      const std::size_t end = begin + rows_in_run * row;
      for (std::size_t first = begin; first < end; first += slab_) {
        const auto first_slot = static_cast<std::uint32_t>(first);
        const std::size_t count = min_of(slab_, end - first);
        const std::size_t met = add_slab(family, first_slot, count, first_slot);
        if (met > 0) add_replacements(met, first_slot);
        tick(count);
      }
    }
  }

  // The spheres of some of a family's places, as a piece. Lists lattice spheres that met the surface, and
  // returns how many.
  std::size_t add_slab(const CandidateFamily& family, std::uint32_t first_slot, std::size_t count,
                       std::uint32_t piece_slot) {
    using namespace hexagonal_detail;
    const View<CandidateState> states{states_.view().data, count};
    executor_.for_each_index(count,
                             Classify{family, first_slot, winding_, grid_, input_.parameters.wall, states});
    executor_.for_each_index(CountStates::threads_for(count), CountStates{states, state_counters_.view()});
    const bool lists_met = family.kind == SphereKind::lattice;
    const Tally total =
        executor_.select(count, TallyStates{states, lists_met},
                         Emit{states, family, first_slot, lists_met, spheres_.view(), met_.view()});
    if (total.first > 0) {
      pieces_.by_kind[static_cast<std::size_t>(family.kind)].push_back(
          {piece_slot, executor_.download(View<const Sphere>{spheres_.view().data, total.first})});
    }
    return total.second;
  }

  // The 61 spheres each in place of the lattice spheres listed.
  void add_replacements(std::size_t met, std::uint32_t piece_slot) {
    CandidateFamily family = family_of(SphereKind::replacement, kRadiusOf61InUnitSphere);
    const std::size_t at_a_time = slab_ / kReplacements;
    for (std::size_t i = 0; i < met; i += at_a_time) {
      family.replaced = {met_.view().data + i, min_of(at_a_time, met - i)};
      add_slab(family, 0, family.replaced.size * kReplacements, piece_slot);
    }
  }

  const Executor& executor_;
  WindingView winding_;
  FacetGridView grid_;
  const HexagonalInput& input_;
  HexagonalPieces& pieces_;
  HexagonalLattice lattice_;
  Buffer<Vec3d> centres_;
  std::size_t slab_;
  Buffer<CandidateState> states_;
  Buffer<Sphere> spheres_;
  Buffer<std::uint32_t> met_;
  Buffer<std::uint64_t> state_counters_;
};

namespace hexagonal_detail {

template <typename Executor>
void pack_rows(const Executor& executor, View<const Facet> facets, const Box3d& region, const CellGrid& cells,
               LatticeRows rows, const HexagonalInput& input, const std::function<void(double)>& progress,
               HexagonalPieces& pieces) {
  const auto winding = build_winding_index(executor, facets, input.box, region);
  const auto grid = build_facet_grid(executor, facets, cells);
  HexagonalResult& result = pieces.result;
  if (const std::size_t bytes = winding.cells.bytes() + grid.bytes(); bytes > result.index_bytes) {
    result.index_bytes = bytes;
    result.index_references = winding.cells.references.size() + grid.cells.references.size();
    result.index_cells = winding.cells.offsets.size() + grid.cells.offsets.size();
  }
  ++result.strips;
  progress(0);
  HexagonalPacker<Executor>(executor, winding.view, grid.view, input, pieces).pack(rows, progress);
}

}  // namespace hexagonal_detail

// With one index of all triangles. Fewer than 2^32 places of a kind (the caller's estimate refuses more).
template <typename Executor>
HexagonalResult pack_hexagonal_at_once(const Executor& executor, const HexagonalInput& input) {
  const auto facets = gather_facets(executor, input.positions, input.triangles);
  const HexagonalLattice lattice = make_hexagonal_lattice(input.box, input.parameters.lattice_radius);
  HexagonalPieces pieces;
  hexagonal_detail::pack_rows(executor, facets.view(), input.box, input.grid, {0, lattice.count_y}, input,
                              input.progress, pieces);
  return pieces.joined();
}

}  // namespace aerate::kernels
