#include "packing/open_networks.h"

#include <algorithm>
#include <utility>

#include "core/disjoint_sets.h"
#include "kernels/constants.h"
#include "packing/drainage_refusals.h"
#include "packing/flood.h"

namespace aerate {
namespace {

// A network is opened where channels reach this share of its volume, or the most of so many attempts.
constexpr double kEnoughReached = 0.8;
constexpr int kMostAttempts = 16;

std::vector<Members> members_by_network(const Draft& draft) {
  std::vector<Members> networks;
  for (std::uint32_t i = 0; i < draft.network_of.size(); ++i) {
    const std::uint32_t n = draft.network_of[i];
    if (n == kNone) continue;
    if (n >= networks.size()) networks.resize(n + 1);
    networks[n].push_back(i);
  }
  return networks;
}

// Can a channel still lead from the hole's void to a neighbour?
bool leaves_room_for_channel(DrainageTask& task, PlacedTubes tubes, const EscapeHole& hole) {
  tubes.place(hole);
  const std::span<const std::uint32_t> ways = task.ways.of(hole.from);
  return std::any_of(ways.begin(), ways.end(), [&](std::uint32_t way) { return is_open(task, tubes, way); });
}

// Floods all networks, and places each channel over which that reaches a void.
std::vector<FloodStep> join_voids(DrainageTask& task, Draft& draft) {
  return flood(task, draft, task.up(), [&](std::size_t way) {
    const bool placed = is_open(task, draft.tubes, way);
    if (placed) draft.tubes.place(task.ways[way].channel);
    return placed;
  });
}

Members reached_by(const std::vector<FloodStep>& steps, const Members& members) {
  Members reached = members;
  std::erase_if(reached, [&](std::uint32_t i) { return steps[i].to == kNone; });
  return reached;
}

// A hole that lets out what runs in a direction; or, where only some sides may have any, the other way.
bool open_towards(DrainageTask& task, Draft& draft, const Members& voids, Vec3d down) {
  return open(task, draft, voids, down) ||
         (!task.request.sides.is_anywhere() && open(task, draft, voids, -down));
}

// Opens a network below and above, before channels take the room for it: at voids from which most of it can
// be reached. Without a hole if there is no place below.
Draft open_network(DrainageTask& task, const Draft& draft, const Members& members) {
  const std::uint32_t network = draft.network_of[members.front()];
  const std::size_t before = draft.tubes.plan().holes.size();
  const bool is_asked_for_below = has_low_hole(task, draft, members);
  Members candidates = members;
  Draft best = draft;
  double most = 0;
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    Draft opened = draft;
    if (!is_asked_for_below && !open_towards(task, opened, candidates, -task.up())) break;
    if (hole_count(opened, network) < 2) open_towards(task, opened, candidates, task.up());
    Draft joined = opened;
    const std::vector<FloodStep> steps = join_voids(task, joined);
    const double volume = volume_of(task, reached_by(steps, members));
    std::vector<std::uint32_t> useless;
    for (std::size_t i = before; i < opened.tubes.plan().holes.size(); ++i) {
      const std::uint32_t from = opened.tubes.plan().holes[i].from;
      const bool is_below = i == before && !is_asked_for_below;
      if (is_below ? volume < kEnoughReached * volume_of(task, members) : steps[from].to == kNone)
        useless.push_back(from);
    }
    if (volume > most) {
      most = volume;
      best = std::move(opened);
    }
    if (useless.empty()) break;
    std::erase_if(candidates, [&](std::uint32_t i) {
      return std::find(useless.begin(), useless.end(), i) != useless.end();
    });
  }
  return best;
}

}  // namespace

Draft find_networks(DrainageTask& task) {
  DisjointSets sets(task.voids.size());
  for (std::size_t way = 0; way < task.ways.size(); ++way) {
    const Channel& channel = task.ways[way].channel;
    if (sets.root(channel.from) == sets.root(channel.to)) continue;
    task.monitor.check_interrupted();
    if (task.ways.is_free(way)) sets.join(channel.from, channel.to);
  }
  Members narrow;
  std::vector<Members> networks(task.voids.size());
  for (std::uint32_t i = 0; i < task.voids.size(); ++i)
    (task.voids[i].takes_tube(task.request.channel_radius) ? networks[sets.root(i)] : narrow).push_back(i);
  std::erase_if(networks, [](const Members& members) { return members.empty(); });
  std::stable_sort(networks.begin(), networks.end(), [&](const Members& a, const Members& b) {
    return volume_of(task, a) > volume_of(task, b);
  });
  Draft draft{.network_of = std::vector<std::uint32_t>(task.voids.size(), kNone),
              .tubes = task.no_tubes,
              .dropped = {},
              .asked_for = {}};
  for (std::uint32_t n = 0; n < networks.size(); ++n) {
    for (const std::uint32_t i : networks[n]) draft.network_of[i] = n;
  }
  leave_out(task, draft, narrow, &UndrainedVoids::narrow);
  return draft;
}

Draft open_where_asked(DrainageTask& task, Draft draft) {
  Members all;
  for (std::uint32_t i = 0; i < draft.network_of.size(); ++i) {
    if (draft.network_of[i] != kNone) all.push_back(i);
  }
  // Rather into a void beside which the hole leaves room for a channel.
  const auto hole_at = [&](Vec3d place) {
    task.monitor.check_interrupted();
    const std::vector<EscapeHole> found = task.places.leading_to(place, all);
    std::vector<EscapeHole> roomy = found;
    std::erase_if(roomy,
                  [&](const EscapeHole& hole) { return !leaves_room_for_channel(task, draft.tubes, hole); });
    const auto hole = first_that_opens(task, draft.tubes, roomy);
    return hole ? hole : first_that_opens(task, draft.tubes, found);
  };
  open_at_each(task.request.escape_holes, [&](Vec3d place) {
    const auto hole = hole_at(place);
    if (!hole)
      throw no_hole_leads_from(place,
                               nearest_place(place, longest_hole(task.request, task.limits), task.clearance,
                                             [&](Vec3d at) { return hole_at(at).has_value(); }),
                               task.request);
    draft.tubes.place(*hole);
    draft.asked_for.push_back(hole->from);
  });
  return draft;
}

Draft open_and_join(DrainageTask& task, Draft draft) {
  const std::vector<Members> networks = members_by_network(draft);
  for (std::uint32_t n = 0; n < networks.size(); ++n) {
    const bool is_worth_it =
        hole_count(draft, n) > 0 || (task.request.escape_holes.size() < 2 &&
                                     volume_of(task, networks[n]) >= kLeastNetworkShare * task.volume);
    if (is_worth_it) draft = open_network(task, draft, networks[n]);
    if (hole_count(draft, n) == 0) leave_out(task, draft, networks[n], &UndrainedVoids::unopened);
  }
  const std::vector<FloodStep> steps = join_voids(task, draft);
  for (std::uint32_t n = 0; n < networks.size(); ++n) {
    const auto is_unreached = [&](std::uint32_t i) {
      return draft.network_of[i] == n && steps[i].to == kNone;
    };
    draft.tubes.remove_tubes_of(is_unreached);
    if (hole_count(draft, n) == 0) continue;
    const Members reached = reached_by(steps, networks[n]);
    if (hole_count(draft, n) >= 2 || open_towards(task, draft, reached, task.up())) {
      Members unreached = networks[n];
      std::erase_if(unreached, [&](std::uint32_t i) { return !is_unreached(i); });
      leave_out(task, draft, unreached, &UndrainedVoids::unreached);
    } else {
      leave_out(task, draft, networks[n], &UndrainedVoids::unopened);
    }
  }
  return draft;
}

}  // namespace aerate
