#include "packing/plan_drainage.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "core/error.h"
#include "packing/drainage_draft.h"
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
      "give a smaller --channel-diameter, or larger voids with --max-radius");
}

void require_open_networks(const DrainageTask& task, const Draft& draft) {
  if (!draft.tubes.plan().holes.empty()) return;
  throw NothingToRemoveError(
      fmt::format("no place was found for two escape holes of {:g} mm, so no void can drain",
                  2 * task.request.hole_radius),
      task.request.escape_holes.empty()
          ? "give a smaller --hole-diameter, larger voids, or places with --escape-hole"
          : "ask for other places, or leave --escape-hole out");
}

void require_drained_networks(const Draft& draft) {
  if (!draft.tubes.plan().holes.empty()) return;
  throw NothingToRemoveError(
      fmt::format("more than {:g} % of every group of voids would stay full, in print orientation and upside "
                  "down",
                  100 * kPoolsAimedAt),
      "give other places with --escape-hole, a smaller --hole-diameter, or larger voids");
}

}  // namespace

PlannedDrainage plan_drainage(const DrainableModel& model, const Packing& packing,
                              const DrainageRequest& request, const CanOpen& can_open, Monitor& monitor) {
  DrainageTask task(model, packing, request, can_open, monitor);
  require_room_for_channels(task);
  Draft draft = find_networks(task);
  draft = open_where_asked(task, std::move(draft));
  draft = open_and_join(task, std::move(draft));
  require_open_networks(task, draft);
  if (request.escape_holes.size() < 2) draft = open_pools(task, std::move(draft));
  draft = add_channels_for_pools(task, std::move(draft));
  draft = leave_out_pools(task, std::move(draft));
  require_drained_networks(draft);
  return planned(task, draft);
}

}  // namespace aerate
