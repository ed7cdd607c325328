#include "packing/cell_drainage.h"

#include <fmt/format.h>
#include <utility>

#include "core/error.h"
#include "packing/cell_drainage_draft.h"
#include "packing/cell_drainage_stages.h"

namespace aerate {
namespace {

void require_open_networks(const CellDrainageTask& task, const CellDraft& draft) {
  if (!draft.holes.empty()) return;
  throw NothingToRemoveError(
      fmt::format("no place was found for two escape holes of {:g} mm, so no void can drain",
                  2 * task.request.hole_radius),
      task.request.escape_holes.empty()
          ? "give a smaller --hole-diameter, larger voids, or places with --escape-hole"
          : "ask for other places, or leave --escape-hole out");
}

void require_drained_networks(const CellDraft& draft) {
  if (!draft.holes.empty()) return;
  throw NothingToRemoveError(
      fmt::format("more than {:g} % of every group of voids would stay full, in print orientation and upside "
                  "down",
                  100 * kPoolsAimedAt),
      "give other places with --escape-hole, a smaller --hole-diameter, or larger voids");
}

}  // namespace

PlannedCellDrainage plan_cell_drainage(const DrainableModel& model, const CellVoids& cells,
                                       const PackingLimits& limits, const DrainageRequest& request,
                                       const CanOpenCell& can_open, const CanOpenWall& can_open_wall,
                                       Monitor& monitor) {
  CellDrainageTask task(model, cells, limits, request, can_open, monitor);
  std::erase_if(task.windows, [&](const CellWindow& window) { return !can_open_wall(window.channel.tube); });
  CellDraft draft = begin_draft(task);
  draft = open_where_asked(task, std::move(draft));
  draft = open_and_join(task, std::move(draft));
  require_open_networks(task, draft);
  draft = add_windows_for_pools(task, std::move(draft));
  if (request.escape_holes.size() < 2) {
    draft = open_pools(task, std::move(draft));
    draft = add_windows_for_pools(task, std::move(draft));
  }
  draft = leave_out_pools(task, std::move(draft));
  require_drained_networks(draft);
  return planned(task, draft);
}

}  // namespace aerate
