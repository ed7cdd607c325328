#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/cells.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "pipeline/drain.h"
#include "pipeline/options.h"
#include "pipeline/prepare.h"

namespace aerate {

// The voids of a result, and what they leave of the model.
struct MadeVoids {
  Packing packing;                       // the voids that are made, or the spheres whose cells they are
  std::optional<CellVoids> cells;        // what is made of them; absent: voids are the packing's own shapes
  std::optional<DrainedVoids> drainage;  // absent: each is sealed
  CarvedModel carved;
  std::vector<std::string> notices = {};  // that hold if this is taken

  std::size_t count() const { return cells ? cells->voids.size() : packing.spheres.size(); }
};

// What was asked for, and how much there was to choose from.
struct TargetFacts {
  SavingTarget asked;
  std::size_t all_voids = 0;  // without a target
  double all_removed = 0;     // mm3
};

// Makes some voids of a result by themselves, by their indices: ascending.
using MakeSome = std::function<MadeVoids(std::span<const std::uint32_t> voids, Monitor& monitor)>;

// Some of the voids with the notices that hold for them; nothing if these alone cannot be made. Begins no stage.
std::optional<MadeVoids> attempt(const MakeSome& make_some, std::span<const std::uint32_t> voids,
                                 Monitor& monitor);

// Of volumes, the fewest that add up to a sum, the largest first; the last is the smallest that will do. Ascending; all
// if even those are less.
std::vector<std::uint32_t> fewest_that_reach(std::span<const double> volumes, double sum);

// Of a result with all voids one with the fewest that reaches the target: exactly for sealed voids, for others as near
// as a few plans come, since what is left of a network may not drain. Passes its notices on. Throws NothingToRemoveError that says how much
// all of them save if that is less, UsageError if the model is light enough without voids.
MadeVoids to_target(const PreparedModel& model, const SavingTarget& target, const Material& material,
                    MadeVoids all, const MakeSome& make_some, TargetFacts& facts, Monitor& monitor);

}  // namespace aerate
