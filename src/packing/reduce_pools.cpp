#include "packing/reduce_pools.h"

#include <limits>
#include <map>

#include "core/disjoint_sets.h"
#include "kernels/constants.h"
#include "packing/flood.h"

namespace aerate {
namespace {

// More channels than the tree's have to reduce what stays to this share of it.
constexpr double kLeastGain = 0.7;

// A void that keeps more than this share of its volume in print orientation is worth a way out upside down.
constexpr double kPoolWorthWay = 0.01;

// Leaves out branches until little stays, or none can be.
Draft leave_out_branches(const DrainageTask& task, Draft draft) {
  while (true) {
    const TrappedPools pools = pools_of(task, draft);
    if (pools.after_both <= kPoolsAimedAt * pools.total) return draft;
    const DrainagePlan& plan = draft.tubes.plan();
    const SpillHeights spills = spill_heights(task.voids, plan, task.up());
    const std::uint32_t chosen = fullest_branch(task.voids, plan, spills, draft.asked_for, kPoolsAimedAt);
    if (chosen == kNone) return draft;
    leave_out(task, draft, branch_of(chosen, spills), &UndrainedVoids::full);
  }
}

// Numbers the sets of voids that are joined anew, since leaving out may have cut some in two, and gives each
// a second hole or leaves it out.
Draft open_parts(DrainageTask& task, Draft draft) {
  DisjointSets sets(task.voids.size());
  for (const Channel& channel : draft.tubes.plan().channels) sets.join(channel.from, channel.to);
  std::map<std::size_t, std::uint32_t> number_of_root;
  std::vector<Members> parts;
  for (std::uint32_t i = 0; i < task.voids.size(); ++i) {
    if (draft.network_of[i] == kNone) continue;
    const auto number = static_cast<std::uint32_t>(parts.size());
    const auto [place, is_new] = number_of_root.try_emplace(sets.root(i), number);
    if (is_new) parts.emplace_back();
    draft.network_of[i] = place->second;
    parts[place->second].push_back(i);
  }
  for (std::uint32_t n = 0; n < parts.size(); ++n) {
    if (hole_count(draft, n) >= 2) continue;
    const Vec3d down = has_low_hole(task, draft, parts[n]) ? task.up() : -task.up();
    if (!open(task, draft, parts[n], down)) leave_out(task, draft, parts[n], &UndrainedVoids::unopened);
  }
  return draft;
}

}  // namespace

Draft open_pools(DrainageTask& task, Draft draft) {
  for (int more = 0; more < kMostMoreHoles; ++more) {
    if (pools_of(task, draft).after_both <= kPoolsAimedAt * task.volume) return draft;
    bool opened = false;
    for (const Pool& pool : upright_pools(task.voids, draft.tubes.plan())) {
      if (pool.volume < kPoolWorthHole * task.volume) return draft;
      opened = open(task, draft, pool.voids, -task.up());
      if (opened) break;
    }
    if (!opened) return draft;
  }
  return draft;
}

Draft add_channels_for_pools(DrainageTask& task, Draft draft) {
  const double before = pools_of(task, draft).after_both;
  if (before <= kPoolsAimedAt * task.volume) return draft;
  const SpillHeights upright = spill_heights(task.voids, draft.tubes.plan(), task.up());
  const std::vector<FloodStep> steps =
      flood(task, draft, -task.up(), [&](std::size_t way) { return is_open(task, draft.tubes, way); });
  std::vector<bool> is_on_way(task.voids.size(), false);
  for (std::uint32_t i = 0; i < task.voids.size(); ++i) {
    if (upright.height[i] == std::numeric_limits<double>::infinity()) continue;
    const double left = task.voids[i].volume_below(task.up(), upright.height[i]);
    if (left < kPoolWorthWay * task.voids[i].volume()) continue;
    for (std::uint32_t at = i; at != kNone && steps[at].to != kNone && !is_on_way[at]; at = steps[at].from)
      is_on_way[at] = true;
  }
  Draft with_more = draft;
  for (std::uint32_t i = 0; i < task.voids.size(); ++i) {
    const std::size_t way = steps[i].way;
    if (is_on_way[i] && way != kExistingChannel && is_open(task, with_more.tubes, way))
      with_more.tubes.place(task.ways[way].channel);
  }
  return pools_of(task, with_more).after_both <= kLeastGain * before ? with_more : draft;
}

Draft leave_out_pools(DrainageTask& task, Draft draft) {
  while (true) {
    draft = leave_out_branches(task, std::move(draft));
    const std::size_t before = draft.dropped.count();
    draft = open_parts(task, std::move(draft));
    if (draft.dropped.count() == before) return draft;
  }
}

}  // namespace aerate
