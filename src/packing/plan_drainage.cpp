#include "packing/plan_drainage.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "core/error.h"
#include "packing/drainage_draft.h"
#include "packing/drainage_refusals.h"
#include "packing/hole_showing.h"
#include "packing/open_networks.h"
#include "packing/reduce_pools.h"

namespace aerate {
namespace {

void require_room_for_channels(const DrainageTask& task) {
  if (task.volume > 0) return;
  double largest = 0;
  for (const VoidShape& shape : task.voids) largest = std::max(largest, shape.radius());
  throw UsageError(
      fmt::format("a channel of {:g} mm is too wide for every void: the largest has a diameter of {:g} mm",
                  2 * task.request.channel_radius, 2 * largest),
      "give " + narrower_channels() + ", or larger voids with --max-radius");
}

}  // namespace

PlannedDrainage plan_drainage(const DrainableModel& model, const Packing& packing,
                              const DrainageRequest& request, const CanOpen& can_open, Monitor& monitor) {
  DrainageTask task(model, packing, request, can_open, monitor);
  require_room_for_channels(task);
  Draft draft = find_networks(task);
  draft = open_where_asked(task, std::move(draft));
  draft = open_and_join(task, std::move(draft));
  if (draft.tubes.plan().holes.empty()) throw nothing_is_opened(request);
  if (request.escape_holes.size() < 2) draft = open_pools(task, std::move(draft));
  draft = add_channels_for_pools(task, std::move(draft));
  draft = leave_out_pools(task, std::move(draft));
  if (draft.tubes.plan().holes.empty()) throw all_stays_full(request);
  PlannedDrainage result = planned(task, draft);
  result.plan.widest_cup = widest_cup(task.voids, draft.tubes.plan());
  describe_holes(result.plan.holes, request, task.places.showing());
  return result;
}

}  // namespace aerate
