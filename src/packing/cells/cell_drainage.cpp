#include "packing/cells/cell_drainage.h"

#include <memory>
#include <utility>

#include "packing/cells/cell_drainage_draft.h"
#include "packing/cells/cell_drainage_stages.h"
#include "packing/drainage_refusals.h"
#include "packing/hole_showing.h"

namespace aerate {
namespace {

// Small voids with channels drain where few large ones with windows do not.
constexpr const char* kOrSpheres = ", or --shape spheres";

}  // namespace

CellDrainagePlanner::CellDrainagePlanner(const DrainableModel& model, const CellVoids& cells,
                                         const PackingLimits& limits, const DrainageRequest& request,
                                         Monitor& monitor)
    : ground_(std::make_unique<CellDrainageGround>(model, cells, limits, request, monitor)),
      monitor_(monitor) {}

CellDrainagePlanner::~CellDrainagePlanner() = default;

PlannedCellDrainage CellDrainagePlanner::plan(const DrainageRequest& request, const CanOpenCell& can_open,
                                              const CanOpenWall& can_open_wall) {
  CellDrainageTask task(*ground_, request, can_open, can_open_wall, monitor_);
  CellDraft draft = begin_draft(task);
  draft = open_where_asked(task, std::move(draft));
  draft = open_and_join(task, std::move(draft));
  if (draft.holes.empty()) throw nothing_is_opened(request, kOrSpheres);
  draft = add_windows_for_pools(task, std::move(draft));
  if (request.escape_holes.size() < 2) {
    draft = open_pools(task, std::move(draft));
    draft = add_windows_for_pools(task, std::move(draft));
  }
  draft = open_cups(task, std::move(draft));
  draft = leave_out_pools(task, std::move(draft));
  if (draft.holes.empty()) throw all_stays_full(request, kOrSpheres);
  PlannedCellDrainage result = planned(task, draft);
  result.plan.widest_cup = widest_cup(task, draft);
  describe_holes(result.plan.holes, request, task.places.front().showing());
  return result;
}

PlannedCellDrainage plan_cell_drainage(const DrainableModel& model, const CellVoids& cells,
                                       const PackingLimits& limits, const DrainageRequest& request,
                                       const CanOpenCell& can_open, const CanOpenWall& can_open_wall,
                                       Monitor& monitor) {
  return CellDrainagePlanner(model, cells, limits, request, monitor).plan(request, can_open, can_open_wall);
}

}  // namespace aerate
