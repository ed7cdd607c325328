#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "kernels/atomic.h"
#include "kernels/facet_grid.h"
#include "kernels/hexagonal_lattice.h"
#include "kernels/sphere.h"
#include "kernels/spheres_61.h"
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

// Candidates in one of two states, by groups: what is scanned is then small, and what is written stays in
// order.
struct Selection {
  static constexpr std::size_t kGroup = 32;
  View<const CandidateState> states;
  CandidateState first, second;

  AERATE_HD bool holds(std::size_t i) const { return states[i] == first || states[i] == second; }
  AERATE_HD std::size_t group_count() const { return (states.size + kGroup - 1) / kGroup; }

  // Calls visit(i, n) for the group's candidates: i its index, n its number within the group. Returns how
  // many there are.
  template <typename Visit>
  AERATE_HD std::uint32_t for_each_in_group(std::size_t group, Visit visit) const {
    std::uint32_t count = 0;
    const std::size_t end = min_of((group + 1) * kGroup, states.size);
    for (std::size_t i = group * kGroup; i < end; ++i) {
      if (holds(i)) visit(i, count++);
    }
    return count;
  }
};

struct CountGroup {
  Selection selection;
  View<std::uint32_t> counts;

  AERATE_HD void operator()(std::size_t group) const {
    counts[group] = selection.for_each_in_group(group, [](std::size_t, std::uint32_t) {});
  }
};

struct ListGroup {
  Selection selection;
  std::uint32_t first_slot;
  View<const std::uint32_t> offsets;
  View<std::uint32_t> slots;

  AERATE_HD void operator()(std::size_t group) const {
    const std::uint32_t offset = offsets[group], first = first_slot;
    const View<std::uint32_t> to = slots;
    selection.for_each_in_group(group, [=](std::size_t i, std::uint32_t n) {
      to[offset + n] = first + static_cast<std::uint32_t>(i);
    });
  }
};

struct EmitGroup {
  Selection selection;
  CandidateFamily family;
  std::uint32_t first_slot;
  View<const std::uint32_t> offsets;
  View<Sphere> spheres;

  AERATE_HD void operator()(std::size_t group) const {
    const EmitGroup& self = *this;
    const std::uint32_t offset = offsets[group];
    selection.for_each_in_group(group, [&self, offset](std::size_t i, std::uint32_t n) {
      const Vec3d centre = self.family.position(self.first_slot + static_cast<std::uint32_t>(i));
      const bool smaller = self.selection.states[i] == CandidateState::kept_smaller;
      self.spheres[offset + n] = {centre, smaller ? self.family.smaller_radius : self.family.radius,
                                  smaller ? SphereKind::interstice : self.family.kind};
    });
  }
};

}  // namespace hexagonal_detail

// Places that are worked on at a time: enough to fill any device, few enough for a caller that wants to know
// of progress.
inline constexpr std::size_t kMostSlots = std::size_t{1} << 20;

// A job, in host memory.
struct HexagonalInput {
  std::span<const Vec3f> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;
  Box3d box{};    // of the positions
  CellGrid grid;  // for the facets
  HexagonalParameters parameters;
  // At a time; fewer if memory asks for it. The result does not depend on it.
  std::size_t most_slots = kMostSlots;
  // Called between pieces of work with the share that is done; what it throws ends the job.
  std::function<void(double)> progress = [](double) {};
};

struct HexagonalResult {
  std::vector<Sphere> spheres;  // lattice, interstices, tetrahedral, replacements; each in lattice order
  // By CandidateState, all kinds together. A lattice sphere that was replaced counts as near_surface, and so
  // does each of its 61 places that stayed empty for that reason.
  std::array<std::uint64_t, kCandidateStates> state_counts{};
  std::size_t index_bytes = 0;
  std::size_t slots_at_a_time = 0;
};

// What the job needs at least for the facets and their index, whatever the size of a slab: with one reference
// for each facet, where there are several.
inline std::size_t least_index_bytes(const HexagonalInput& input) {
  const std::size_t facets = input.triangles.size();
  const auto columns = static_cast<std::size_t>(static_cast<double>(facets) / kFacetsPerColumn);
  return facets * (sizeof(Facet) + 2 * sizeof(std::uint32_t)) +
         (columns + 2 * input.grid.cell_count()) * sizeof(std::uint32_t);
}

// Memory that one place needs at most while it is worked on: its state, its share of two counts for its
// group, its sphere, and its entry in the list of replaced spheres.
inline constexpr std::size_t kBytesPerSlot =
    sizeof(CandidateState) + 1 + sizeof(Sphere) + sizeof(std::uint32_t);

// Packs in slabs of places: all kinds of sphere, one after the other, and the replacements of a slab's
// lattice spheres at once.
template <typename Executor>
class HexagonalPacker {
 public:
  HexagonalPacker(const Executor& executor, const WindingView& winding, const FacetGridView& grid,
                  const HexagonalInput& input)
      : executor_(executor),
        winding_(winding),
        grid_(grid),
        input_(input),
        lattice_(make_hexagonal_lattice(winding.box, input.parameters.lattice_radius)),
        centres_(executor.upload(std::span<const Vec3d>(kCentresOf61InUnitSphere))),
        slab_(slab_for(executor.free_bytes(), input.most_slots)),
        states_(executor.template allocate<CandidateState>(slab_)),
        counts_(executor.template allocate<std::uint32_t>(groups_of(slab_))),
        offsets_(executor.template allocate<std::uint32_t>(groups_of(slab_))),
        state_counters_(executor.template allocate<std::uint64_t>(kCandidateStates)) {}

  HexagonalResult pack() {
    executor_.for_each_index(kCandidateStates, SetAll<std::uint64_t>{state_counters_.view(), 0});
    add_family(family_of(SphereKind::lattice, 1.0), kLatticePerCell);
    add_family(family_of(SphereKind::interstice, kInterstice), kIntersticesPerCell);
    CandidateFamily tetrahedral = family_of(SphereKind::tetrahedral, kTetrahedral);
    tetrahedral.smaller_radius = radius_of(kInterstice);
    add_family(tetrahedral, kTetrahedralPerCell);

    HexagonalResult result;
    result.slots_at_a_time = slab_;
    std::size_t total = 0;
    for (const auto& pieces : pieces_)
      for (const std::vector<Sphere>& piece : pieces) total += piece.size();
    result.spheres.reserve(total);
    for (auto& pieces : pieces_) {
      for (const std::vector<Sphere>& piece : pieces)
        result.spheres.insert(result.spheres.end(), piece.begin(), piece.end());
      pieces.clear();
    }
    const std::vector<std::uint64_t> counts =
        executor_.download(View<const std::uint64_t>(state_counters_.view()));
    std::copy(counts.begin(), counts.end(), result.state_counts.begin());
    return result;
  }

 private:
  template <typename T>
  using Buffer = typename Executor::template Buffer<T>;

  static constexpr std::size_t kLeastSlab = 1024;
  static std::size_t groups_of(std::size_t slots) {
    return (slots + hexagonal_detail::Selection::kGroup - 1) / hexagonal_detail::Selection::kGroup;
  }

  // A tenth of the memory is left for what allocators and scans need beside.
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

  void add_family(const CandidateFamily& family, std::size_t slots_per_cell) {
    const std::size_t slots = lattice_.cell_count() * slots_per_cell;
    for (std::size_t first = 0; first < slots; first += slab_) {
      const auto first_slot = static_cast<std::uint32_t>(first);
      const std::size_t count = min_of(slab_, slots - first);
      add_slab(family, first_slot, count);
      if (family.kind == SphereKind::lattice) add_replacements(first_slot, count);
      done_ += static_cast<double>(count);
      input_.progress(done_ / slots_in_all());
    }
  }

  double slots_in_all() const {
    return static_cast<double>(lattice_.cell_count()) *
           (kLatticePerCell + kIntersticesPerCell + kTetrahedralPerCell);
  }

  // The spheres of some of a family's places. Leaves their states.
  void add_slab(const CandidateFamily& family, std::uint32_t first_slot, std::size_t count) {
    using namespace hexagonal_detail;
    const View<CandidateState> states{states_.view().data, count};
    executor_.for_each_index(count,
                             Classify{family, first_slot, winding_, grid_, input_.parameters.wall, states});
    executor_.for_each_index(CountStates::threads_for(count), CountStates{states, state_counters_.view()});

    const Selection kept{states, CandidateState::kept, CandidateState::kept_smaller};
    const std::size_t total = count_groups(kept);
    if (total == 0) return;
    if (spheres_.size() < total) {
      spheres_ = {};
      spheres_ = executor_.template allocate<Sphere>(total);
    }
    const View<Sphere> spheres{spheres_.view().data, total};
    executor_.for_each_index(kept.group_count(),
                             EmitGroup{kept, family, first_slot, offsets_.view(), spheres});
    pieces_[static_cast<std::size_t>(family.kind)].push_back(executor_.download(View<const Sphere>(spheres)));
  }

  // The 61 spheres each in place of those lattice spheres of the last slab that met the surface.
  void add_replacements(std::uint32_t first_slot, std::size_t count) {
    using namespace hexagonal_detail;
    const Selection met{
        {states_.view().data, count}, CandidateState::near_surface, CandidateState::near_surface};
    const std::size_t total = count_groups(met);
    if (total == 0) return;
    Buffer<std::uint32_t> replaced = executor_.template allocate<std::uint32_t>(total);
    executor_.for_each_index(met.group_count(), ListGroup{met, first_slot, offsets_.view(), replaced.view()});
    CandidateFamily family = family_of(SphereKind::replacement, kRadiusOf61InUnitSphere);
    const std::size_t at_a_time = slab_ / kReplacements;
    for (std::size_t i = 0; i < total; i += at_a_time) {
      family.replaced = {replaced.view().data + i, min_of(at_a_time, total - i)};
      add_slab(family, 0, family.replaced.size * kReplacements);
    }
  }

  // Leaves the groups' offsets.
  std::size_t count_groups(const hexagonal_detail::Selection& selection) {
    const std::size_t groups = selection.group_count();
    const View<std::uint32_t> counts{counts_.view().data, groups};
    executor_.for_each_index(groups, hexagonal_detail::CountGroup{selection, counts});
    return executor_.exclusive_scan(counts, View<std::uint32_t>{offsets_.view().data, groups});
  }

  const Executor& executor_;
  WindingView winding_;
  FacetGridView grid_;
  const HexagonalInput& input_;
  HexagonalLattice lattice_;
  Buffer<Vec3d> centres_;
  std::size_t slab_;
  Buffer<CandidateState> states_;
  Buffer<std::uint32_t> counts_, offsets_;
  Buffer<std::uint64_t> state_counters_;
  Buffer<Sphere> spheres_;
  double done_ = 0;
  std::array<std::vector<std::vector<Sphere>>, 4> pieces_;  // by SphereKind
};

// The whole job. The triangles go to the executor's memory once, and each sphere comes back once. Fewer than
// 2^32 places of a kind (the caller's estimate refuses more).
template <typename Executor>
HexagonalResult pack_hexagonal(const Executor& executor, const HexagonalInput& input) {
  const auto facets = gather_facets(executor, input.positions, input.triangles);
  const auto winding = build_winding_index(executor, facets.view(), input.box);
  const auto grid = build_facet_grid(executor, facets.view(), input.grid);
  input.progress(0);
  HexagonalResult result = HexagonalPacker(executor, winding.view, grid.view, input).pack();
  result.index_bytes = winding.bytes() + grid.bytes();
  return result;
}

}  // namespace aerate::kernels
