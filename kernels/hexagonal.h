#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/atomic.h"
#include "kernels/facet_grid.h"
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

// Radii of the scheme for lattice spheres of radius 1.
inline constexpr double kInterstice = 0.154700538379251529;  // 2 / sqrt(3) - 1 (Eq. 1)
inline constexpr double kTetrahedral =
    0.224744871391589049;  // sqrt(3 / 2) - 1: the sphere that fits (not Eq. 2)

// Spheres of the scheme come in cells of one "hepta-sphere": two lattice spheres, four interstices, and a
// tetrahedral hole above and below two of these.
inline constexpr std::size_t kLatticePerCell = 2;
inline constexpr std::size_t kIntersticesPerCell = 4;
inline constexpr std::size_t kTetrahedralPerCell = 4;

struct HexagonalLattice {
  Box3d box{};
  double radius = 1;
  std::size_t count_x = 0, count_y = 0, count_z = 0;

  AERATE_HD std::size_t cell_count() const { return count_x * count_y * count_z; }
  AERATE_HD bool is_odd_layer(std::size_t cell) const { return cell / (count_x * count_y) % 2 != 0; }

  // p0 of the paper.
  AERATE_HD Vec3d cell_position(std::size_t cell) const {
    const std::size_t column = cell % count_x, row = cell / count_x % count_y,
                      layer = cell / (count_x * count_y);
    const double i = static_cast<double>(column);
    const double j = static_cast<double>(row);
    const double k = static_cast<double>(layer);
    const bool odd = is_odd_layer(cell);
    return {box.lower.x + radius * (1 + 2 * i + (odd ? 1.0 : 0.0)),
            box.lower.y + radius * (1 + kRow * 2 * j + (odd ? kBarycentre : 0.0)),
            box.lower.z + radius * kLayer * k};
  }

  AERATE_HD Vec3d lattice_position(std::size_t slot) const {
    const Vec3d p0 = cell_position(slot / kLatticePerCell);
    return slot % kLatticePerCell == 0 ? p0 : p0 + Vec3d{radius, radius * kRow, 0};
  }

  // p3, p4, p5, p6 of the paper.
  AERATE_HD Vec3d interstice_position(std::size_t slot) const {
    const Vec3d p0 = cell_position(slot / kIntersticesPerCell);
    switch (slot % kIntersticesPerCell) {
      case 0:
        return p0 + Vec3d{0, -2 * kBarycentre * radius, 0};
      case 1:
        return p0 + Vec3d{radius, -kBarycentre * radius, 0};
      case 2:
        return p0 + Vec3d{radius, kBarycentre * radius, 0};
      default:
        return p0 + Vec3d{0, 2 * kBarycentre * radius, 0};
    }
  }

  // Above and below those interstices that have a lattice sphere of the next layers over them.
  AERATE_HD Vec3d tetrahedral_position(std::size_t slot) const {
    const std::size_t cell = slot / kTetrahedralPerCell;
    const std::size_t which = slot % kTetrahedralPerCell;
    const bool first = which < 2;
    const std::size_t interstice = is_odd_layer(cell) ? (first ? 1 : 3) : (first ? 0 : 2);
    const Vec3d base = interstice_position(cell * kIntersticesPerCell + interstice);
    return base + Vec3d{0, 0, which % 2 == 0 ? kTetrahedralHeight * radius : -kTetrahedralHeight * radius};
  }

  // For lattice spheres of radius 1:
  static constexpr double kRow = 1.732050807568877294;                // sqrt(3): distance of rows
  static constexpr double kBarycentre = 0.577350269189625765;         // 1 / sqrt(3): row to barycentre
  static constexpr double kLayer = 1.632993161855452065;              // 2 sqrt(2 / 3): pitch of layers
  static constexpr double kTetrahedralHeight = 0.408248290463863016;  // 1 / sqrt(6): layer to hole
};

// Cells whose p0 is inside the box, the odd layers' shift left aside.
inline HexagonalLattice make_hexagonal_lattice(const Box3d& box, double radius) {
  const auto steps = [](double extent, double pitch) {
    return extent < 0 ? std::size_t{0} : static_cast<std::size_t>(extent / pitch) + 1;
  };
  HexagonalLattice lattice{box, radius, 0, 0, 0};
  lattice.count_x = steps(box.upper.x - box.lower.x - radius, 2 * radius);
  lattice.count_y = steps(box.upper.y - box.lower.y - radius, 2 * HexagonalLattice::kRow * radius);
  lattice.count_z = steps(box.upper.z - box.lower.z, HexagonalLattice::kLayer * radius);
  return lattice;
}

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
  std::size_t slots;

  AERATE_HD Vec3d position(std::size_t slot) const {
    switch (kind) {
      case SphereKind::lattice:
        return lattice.lattice_position(slot);
      case SphereKind::interstice:
        return lattice.interstice_position(slot);
      case SphereKind::tetrahedral:
        return lattice.tetrahedral_position(slot);
      default:
        return lattice.lattice_position(replaced[slot / replacement_centres.size]) +
               replacement_centres[slot % replacement_centres.size] * lattice.radius;
    }
  }
};

namespace hexagonal_detail {

struct Classify {
  CandidateFamily family;
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

  AERATE_HD void operator()(std::size_t slot) const { states[slot] = classify(family.position(slot)); }
};

struct FlagStates {
  View<const CandidateState> states;
  CandidateState first, second;
  View<std::uint32_t> flags;

  AERATE_HD void operator()(std::size_t i) const {
    flags[i] = states[i] == first || states[i] == second ? 1 : 0;
  }
};

struct ListFlagged {
  View<const std::uint32_t> flags;
  View<const std::uint32_t> places;
  View<std::uint32_t> list;

  AERATE_HD void operator()(std::size_t i) const {
    if (flags[i] != 0) list[places[i]] = static_cast<std::uint32_t>(i);
  }
};

// Counts states in runs, so that few threads meet at a counter.
struct CountStates {
  static constexpr std::size_t kRun = 1024;
  View<const CandidateState> states;
  View<std::uint32_t> counters;

  AERATE_HD void operator()(std::size_t run) const {
    const std::size_t end = min_of((run + 1) * kRun, states.size);
    for (std::size_t state = 0; state < kCandidateStates; ++state) {
      std::uint32_t count = 0;
      for (std::size_t i = run * kRun; i < end; ++i) {
        if (static_cast<std::size_t>(states[i]) == state) ++count;
      }
      if (count != 0) atomic_add(counters[state], count);
    }
  }
};

struct EmitSpheres {
  CandidateFamily family;
  View<const CandidateState> states;
  View<const std::uint32_t> list;
  View<Sphere> spheres;

  AERATE_HD void operator()(std::size_t i) const {
    const std::size_t slot = list[i];
    const bool smaller = states[slot] == CandidateState::kept_smaller;
    spheres[i] = {family.position(slot), smaller ? family.smaller_radius : family.radius,
                  smaller ? SphereKind::interstice : family.kind};
  }
};

// Candidates in either of two states, ascending.
template <typename Executor>
typename Executor::template Buffer<std::uint32_t> list_candidates(const Executor& executor,
                                                                  View<const CandidateState> states,
                                                                  CandidateState first,
                                                                  CandidateState second) {
  auto flags = executor.template allocate<std::uint32_t>(states.size);
  auto places = executor.template allocate<std::uint32_t>(states.size);
  executor.for_each_index(states.size, FlagStates{states, first, second, flags.view()});
  const std::uint64_t total = executor.exclusive_scan(flags.view(), places.view());
  auto list = executor.template allocate<std::uint32_t>(total);
  executor.for_each_index(states.size, ListFlagged{flags.view(), places.view(), list.view()});
  return list;
}

}  // namespace hexagonal_detail

struct HexagonalResult {
  std::vector<Sphere> spheres;  // lattice, interstices, tetrahedral, replacements; each in lattice order
  // By CandidateState, all kinds together. A lattice sphere that was replaced counts as near_surface, and so
  // does each of its 61 places that stayed empty for that reason.
  std::uint64_t state_counts[kCandidateStates] = {};
};

// Bytes that one candidate needs while its family is processed: state, flag, place.
inline constexpr std::size_t kBytesPerCandidate = sizeof(CandidateState) + 2 * sizeof(std::uint32_t);

// Packs the inside of the indexed facets. One family of spheres after the other is classified, listed and
// emitted, so that memory is that of the most numerous one; none may have 2^32 places or more (the caller's
// estimate refuses such a job).
template <typename Executor>
HexagonalResult pack_hexagonal(const Executor& executor, const WindingView& winding,
                               const FacetGridView& grid, const HexagonalParameters& parameters) {
  using State = CandidateState;
  // The radius of a family whose spheres have `relative` radius for lattice spheres of 1; 0 if that is below
  // the limit, which rounding must not decide where both are equal.
  const auto radius_of = [&](double relative) {
    const double planned = relative * parameters.lattice_radius - parameters.half_gap;
    const double radius = planned - parameters.rounding_slack;
    return planned >= parameters.min_radius - parameters.rounding_slack && radius > 0 ? radius : 0.0;
  };
  const HexagonalLattice lattice = make_hexagonal_lattice(winding.box, parameters.lattice_radius);
  const auto centres = executor.upload(std::span<const Vec3d>(kCentresOf61InUnitSphere));
  HexagonalResult result;
  typename Executor::template Buffer<std::uint32_t> replaced;

  const auto add_family = [&](const CandidateFamily& family) {
    auto states = executor.template allocate<State>(family.slots);
    const View<const State> states_view = states.view();
    executor.for_each_index(
        family.slots, hexagonal_detail::Classify{family, winding, grid, parameters.wall, states.view()});

    auto counters = executor.template allocate<std::uint32_t>(kCandidateStates);
    executor.for_each_index(kCandidateStates, SetAll<std::uint32_t>{counters.view(), 0});
    constexpr std::size_t kRun = hexagonal_detail::CountStates::kRun;
    executor.for_each_index((family.slots + kRun - 1) / kRun,
                            hexagonal_detail::CountStates{states_view, counters.view()});
    const std::vector<std::uint32_t> counts = executor.download(View<const std::uint32_t>(counters.view()));
    for (std::size_t i = 0; i < kCandidateStates; ++i) result.state_counts[i] += counts[i];

    const auto list =
        hexagonal_detail::list_candidates(executor, states_view, State::kept, State::kept_smaller);
    auto spheres = executor.template allocate<Sphere>(list.size());
    executor.for_each_index(list.size(),
                            hexagonal_detail::EmitSpheres{family, states_view, list.view(), spheres.view()});
    const std::vector<Sphere> kept = executor.download(View<const Sphere>(spheres.view()));
    result.spheres.insert(result.spheres.end(), kept.begin(), kept.end());
    if (family.kind == SphereKind::lattice) {
      replaced =
          hexagonal_detail::list_candidates(executor, states_view, State::near_surface, State::near_surface);
    }
  };

  const auto family_of = [&](SphereKind kind, double relative, std::size_t slots) {
    return CandidateFamily{lattice, kind, radius_of(relative), 0.0, centres.view(), replaced.view(), slots};
  };
  add_family(family_of(SphereKind::lattice, 1.0, lattice.cell_count() * kLatticePerCell));
  add_family(family_of(SphereKind::interstice, kInterstice, lattice.cell_count() * kIntersticesPerCell));
  CandidateFamily tetrahedral =
      family_of(SphereKind::tetrahedral, kTetrahedral, lattice.cell_count() * kTetrahedralPerCell);
  tetrahedral.smaller_radius = radius_of(kInterstice);
  add_family(tetrahedral);
  add_family(family_of(SphereKind::replacement, kRadiusOf61InUnitSphere, replaced.size() * centres.size()));
  return result;
}

}  // namespace aerate::kernels
