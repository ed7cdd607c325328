#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/monitor.h"
#include "pipeline/prepare.h"
#include "pipeline/target.h"
#include "printing/footing.h"

namespace aerate {

// What was asked for, and what the voids had to be chosen for.
struct StandFacts {
  double asked = 0;            // mm further inside than the solid model's centre of mass
  double needed = 0;           // how far inside the footprint it has to be, mm
  double margin_before = 0;    // of the solid model, mm
  double margin_with_all = 0;  // with every void, mm
  std::size_t all_voids = 0;
};

// How much is in one place, as it bears on balance: mm3, and where its centre is seen along up, mm.
struct Weight {
  double volume = 0;
  double x = 0, y = 0;
};

// How far inside the footprint the centre of mass has to be: as far as it was but for a hundredth, and further by `asked` (less,
// if that is negative); in the footprint in any case. Millimetres.
double needed_margin(double before, double asked);

// Of voids in a solid those to make so that the centre of mass of what is left is at least `needed` mm inside the footprint. Of a
// few voids the largest of all such choices. Of more, while it is not, the one is left out that moves it best for its volume, which
// lies farthest from the footprint's nearest edge; then those are made again, the largest first, that do no harm; if that leaves
// none, all choices of the largest few are looked at. Ascending; if there is no such choice, how near the best one came.
struct StandingChoice {
  std::optional<std::vector<std::uint32_t>> voids;
  double best_margin = 0;
};
StandingChoice choose_standing(const Footprint& footprint, const Weight& solid, std::span<const Weight> voids,
                               double needed);

// Of a result with all voids one that stands as it should, by what is measured on it; what was chosen is carved again, and what drains
// is planned again, with up to ten choices. `up`: against gravity. Passes its notices on. Throws NothingToRemoveError that
// says how far off it is for a model that stands on no area or that no choice of voids lets stand, UsageError for one
// whose parts overlap, so that it has no centre of mass.
MadeVoids to_stand(const PreparedModel& model, double asked, Vec3d up, MadeVoids all,
                   const MakeSome& make_some, StandFacts& facts, Monitor& monitor);

}  // namespace aerate
