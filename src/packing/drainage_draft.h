#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <vector>

#include "core/drainage.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/void_shape.h"
#include "kernels/constants.h"
#include "packing/channel_ways.h"
#include "packing/hole_places.h"
#include "packing/placed_tubes.h"
#include "packing/plan_drainage.h"
#include "packing/pools.h"
#include "packing/tube_clearance.h"

// What the stages of planning hand on to each other.

namespace aerate {

// What is asked for, and what can be looked up: answers are remembered, so it is the same for all drafts.
struct DrainageTask {
  DrainageTask(const DrainableModel& model, const Packing& packing, const DrainageRequest& asked,
               const CanOpen& can_cut, Monitor& watched);
  DrainageTask(const DrainageTask&) = delete;
  DrainageTask& operator=(const DrainageTask&) = delete;

  const DrainageRequest& request;
  const CanOpen& can_open;
  Monitor& monitor;
  PackingLimits limits;
  std::vector<VoidShape> voids;
  double volume = 0;  // of the voids that are wide enough for a channel, mm3
  double longest_channel;
  PlacedTubes no_tubes;
  TubeClearance clearance;
  ChannelWays ways;
  HolePlaces places;
  std::set<std::tuple<std::uint32_t, double, double, double>> uncut;  // where holes are known not to be cut

  Vec3d up() const { return limits.roof.up; }
};

// A plan that is being made.
struct Draft {
  std::vector<std::uint32_t> network_of;  // by void; kNone for those that are left out
  PlacedTubes tubes;
  UndrainedVoids dropped;
  std::vector<std::uint32_t> asked_for;  // voids with holes that were asked for
};

// Voids of a network, ascending.
using Members = std::vector<std::uint32_t>;

double volume_of(const DrainageTask& task, const Members& members);

// Counts voids as not made, for the given reason, and removes their tubes.
void leave_out(const DrainageTask& task, Draft& draft, const Members& members,
               std::size_t UndrainedVoids::*reason);

std::ptrdiff_t hole_count(const Draft& draft, std::uint32_t network);
// Is there a hole in the lower half of a network, or are there two anywhere?
bool has_low_hole(const DrainageTask& task, const Draft& draft, const Members& members);

// Can the channel of a way still be placed? Throws InterruptedError.
bool is_open(DrainageTask& task, const PlacedTubes& tubes, std::size_t way);

// The first of the holes that keeps clear of tubes, is sound, and can be cut.
std::optional<EscapeHole> first_that_opens(DrainageTask& task, const PlacedTubes& tubes,
                                           std::span<const EscapeHole> holes);
// Places the best hole out of one of the voids, where liquid that runs `down` leaves them. Was there one?
bool open(DrainageTask& task, Draft& draft, const Members& voids, Vec3d down);

// The voids that are kept so far, and the plan as it counts them, with its pools.
PlannedDrainage planned(const DrainageTask& task, const Draft& draft);
inline TrappedPools pools_of(const DrainageTask& task, const Draft& draft) {
  return planned(task, draft).plan.pools;
}

}  // namespace aerate
