#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/cells.h"
#include "core/drainage.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "packing/plan_drainage.h"

namespace aerate {

struct PlannedCellDrainage {
  std::vector<std::uint32_t> kept;  // indices into cells.voids, ascending; the plan counts these
  // Channels are windows: round tubes across the wall between two cells, parallel to its normal, that end in
  // both voids just beyond its faces (packing/cells/cell_windows.h).
  DrainagePlan plan;
  UndrainedVoids dropped;
};

// Can the surfaces be opened for this hole, out of that void (index into cells.voids)?
using CanOpenCell = std::function<bool(const Tube& tube, std::uint32_t from)>;

// Can a wall be opened for this window? It may be known not to be only when it was tried.
using CanOpenWall = std::function<bool(const Tube& window)>;

// Joins voids that are cells by windows in their walls, and opens them to the outside.
//
// Voids are the nodes of a graph, its edges round places in the flat parts of both faces of a wall
// (packing/cells/cell_windows.h); a wall without such a place is no edge. Each connected set of voids that is
// large enough gets an escape hole for print orientation and one for the model upside down
// (packing/cells/cell_drainage_holes.h). From the low hole a flood in order of height, through the hollows of all
// voids (packing/cells/cell_drainage_pools.h; Barnes, Lehman and Mulla 2014), makes the spanning tree: each void
// is joined so that its liquid has to rise least. While more than a hundredth of the volume stays after both
// orientations: windows beside the tree, which nobody sees; then holes for the largest pools (unless both
// were asked for), and windows again; at last voids of which too much would stay full are left out.
//
// `limits`: wall, gap, and `roof.up`, against gravity as printed. Deterministic. Throws UsageError if an
// escape hole was asked for away from the surface or where no tube reaches a void; NothingToRemoveError if
// nothing can be opened; InterruptedError.
PlannedCellDrainage plan_cell_drainage(const DrainableModel& model, const CellVoids& cells,
                                       const PackingLimits& limits, const DrainageRequest& request,
                                       const CanOpenCell& can_open, const CanOpenWall& can_open_wall,
                                       Monitor& monitor);

struct CellDrainageGround;

// The same for several plans of the same cells, of which the first that ask for something find it out for all.
class CellDrainagePlanner {
 public:
  // All that is given has to outlive this.
  CellDrainagePlanner(const DrainableModel& model, const CellVoids& cells, const PackingLimits& limits,
                      const DrainageRequest& request, Monitor& monitor);
  ~CellDrainagePlanner();
  CellDrainagePlanner(const CellDrainagePlanner&) = delete;
  CellDrainagePlanner& operator=(const CellDrainagePlanner&) = delete;

  // For a request with the same tubes and sides as the planner's. Throws what plan_cell_drainage throws.
  PlannedCellDrainage plan(const DrainageRequest& request, const CanOpenCell& can_open,
                           const CanOpenWall& can_open_wall);

 private:
  std::unique_ptr<CellDrainageGround> ground_;
  Monitor& monitor_;
};

}  // namespace aerate
