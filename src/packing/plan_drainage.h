#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "core/drainage.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/surface_index.h"

namespace aerate {

// Why voids of a packing are not made when they have to drain. Each is counted once.
struct UndrainedVoids {
  std::size_t narrow = 0;     // too small for a channel to open into
  std::size_t unreached = 0;  // no channel keeps wall and gap on its way there
  std::size_t unopened = 0;   // in a network for which no place for two escape holes was found, or too
                              // small a one to be worth them
  std::size_t full = 0;       // on a branch of which too much would stay full
  double volume = 0;          // of all these, mm3
  std::size_t count() const { return narrow + unreached + unopened + full; }
};

struct PlannedDrainage {
  std::vector<std::uint32_t> kept;  // indices into the packing, ascending; the plan counts these
  DrainagePlan plan;
  UndrainedVoids dropped;
};

// A network of its own is opened if it holds at least this share of the voids' volume: its two holes show.
inline constexpr double kLeastNetworkShare = 0.05;

// More holes for pools at most, each for one of at least this share of the voids' volume.
inline constexpr int kMostMoreHoles = 24;
inline constexpr double kPoolWorthHole = 0.003;

// Can the surface be opened for this hole? Its `from` counts the packing.
using CanOpen = std::function<bool(const EscapeHole& hole)>;

// A closed model. Holes lead out of its outward shells: the space inside an inward shell is sealed itself.
struct DrainableModel {
  const SurfaceIndex& surface;
  const kernels::WindingView& outward;  // of those of its triangles that bound it outside; 0 outside of all
  // Of regions within the model that tubes keep the wall from all the way; null: there are none.
  const SurfaceIndex* kept = nullptr;
  double plate = -std::numeric_limits<double>::infinity();  // height of its lowest point as printed, mm
};

// Joins voids by straight channels and opens them to the outside.
//
// Voids are the nodes of a graph; its edges are channels that keep the wall from the surface, and the gap
// from other voids and channels; where voids have roofs, they open below these or come straight out of their
// tops, and lean no further than the printer bridges their ceilings. Print orientation is that of
// `packing.limits.roof`. Each connected set of voids that is large enough gets an escape hole for print
// orientation, low and where it shows little, and one for the model upside down. From the low hole a flood in
// order of height (flood.h) makes the spanning tree: each void is joined so that its liquid has to rise least
// to run out. While more than a hundredth of the voids' volume stays after both orientations, the largest
// pools get holes of their own (unless both holes were asked for), then channels beside the tree, and at last
// branches of which too much would stay full are left out.
//
// Deterministic. Throws UsageError if no void is wide enough, if an escape hole was asked for away from the
// surface or where no tube reaches a void; NothingToRemoveError if no network can be opened;
// InterruptedError.
PlannedDrainage plan_drainage(const DrainableModel& model, const Packing& packing,
                              const DrainageRequest& request, const CanOpen& can_open, Monitor& monitor);

}  // namespace aerate
