#include <algorithm>
#include <functional>
#include <utility>

#include "core/disjoint_sets.h"
#include "kernels/constants.h"
#include "packing/cells/cell_drainage_stages.h"
#include "packing/drainage_refusals.h"
#include "packing/hole_rules.h"

namespace aerate {
namespace {

// A network is opened where windows reach this share of its volume, or the most of so many attempts.
constexpr double kEnoughReached = 0.8;
constexpr int kMostAttempts = 8;

// Sets of kept voids that any windows could join, the largest first.
std::vector<CellMembers> networks_of(const CellDrainageTask& task, const CellDraft& draft) {
  CellDraft joined = draft;
  joined.windows.clear();
  for (std::uint32_t window = 0; window < task.windows.size(); ++window) {
    const Channel& channel = task.windows[window].channel;
    if (draft.is_kept[channel.from] != 0 && draft.is_kept[channel.to] != 0) joined.windows.push_back(window);
  }
  std::vector<CellMembers> networks = parts_of(task, joined);
  std::stable_sort(networks.begin(), networks.end(), [&](const CellMembers& a, const CellMembers& b) {
    return volume_of(task, a) > volume_of(task, b);
  });
  return networks;
}

// The lowest of some holes; there is one.
std::uint32_t lowest_of(const CellDrainageTask& task, const CellDraft& draft,
                        std::span<const std::uint32_t> holes) {
  return *std::min_element(holes.begin(), holes.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vec3d up = task.limits.roof.up;
    return std::pair(dot(draft.holes[a]->hole.tube.end, up), a) <
           std::pair(dot(draft.holes[b]->hole.tube.end, up), b);
  });
}

// Is there a hole in the lower half of some voids, or are there two anywhere?
bool has_low_hole(const CellDrainageTask& task, const CellDraft& draft, const CellMembers& members) {
  double lowest = kInfinity, highest = -kInfinity;
  for (const std::uint32_t i : members) {
    for (const double bottom : task.hollows[i].in(kUpright).bottom) lowest = std::min(lowest, bottom);
    for (const double bottom : task.hollows[i].in(kUpsideDown).bottom) highest = std::max(highest, -bottom);
  }
  const std::vector<std::uint32_t> holes = holes_of(draft, members);
  return holes.size() >= 2 || std::any_of(holes.begin(), holes.end(), [&](std::uint32_t hole) {
           return dot(draft.holes[hole]->hole.tube.end, task.limits.roof.up) < (lowest + highest) / 2;
         });
}

// Floods a network from its lowest hole and places each window over which that comes to a void first. Gives
// the voids that are reached.
CellMembers join_voids(const CellDrainageTask& task, CellDraft& draft, const CellMembers& members) {
  const std::vector<std::uint32_t> holes = holes_of(draft, members);
  if (holes.empty()) return {};
  const CellHole& root = *draft.holes[lowest_of(task, draft, holes)];
  std::vector<std::uint32_t> candidates;
  Passages passages;
  for (std::uint32_t window = 0; window < task.windows.size(); ++window) {
    if (!std::binary_search(members.begin(), members.end(), task.windows[window].channel.from)) continue;
    candidates.push_back(window);
    passages.push_back(&task.windows[window].passage);
  }
  passages.push_back(&root.passage);
  std::vector<char> is_reached(task.void_count(), 0);
  is_reached[root.hole.from] = 1;
  const auto accept = [&](std::size_t passage, bool reaches_a_void) {
    const std::uint32_t window = candidates[passage];
    if (!reaches_a_void || !is_open(task, draft, window)) return false;
    draft.windows.push_back(window);
    is_reached[task.windows[window].channel.from] = 1;
    is_reached[task.windows[window].channel.to] = 1;
    return true;
  };
  task.pools.flood(passages, kUpright, accept);
  CellMembers reached = members;
  std::erase_if(reached, [&](std::uint32_t i) { return is_reached[i] == 0; });
  return reached;
}

// A second hole: high, or else wherever there is a place.
bool open_above(CellDrainageTask& task, CellDraft& draft, const CellMembers& voids) {
  return open_voids(task, draft, voids, kUpsideDown) || open_voids(task, draft, voids, kUpright);
}

// A hole low down; or, where only some sides may have any, wherever there is a place.
bool open_below(CellDrainageTask& task, CellDraft& draft, const CellMembers& voids) {
  return open_voids(task, draft, voids, kUpright) ||
         (!task.request.sides.is_anywhere() && open_voids(task, draft, voids, kUpsideDown));
}

// Opens a network below and above and joins its voids, where most of them are reached. Without holes if there
// are no places for two.
CellDraft open_network(CellDrainageTask& task, const CellDraft& draft, const CellMembers& members) {
  CellMembers candidates = members;
  const bool is_asked_for_below = has_low_hole(task, draft, members);
  CellDraft best = draft;
  double most = 0;
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    CellDraft opened = draft;
    if (!is_asked_for_below && !open_below(task, opened, candidates)) break;
    const std::uint32_t low = opened.holes.back()->hole.from;
    const bool needs_high = holes_of(opened, members).size() < 2;
    const bool has_high = needs_high && open_voids(task, opened, members, kUpsideDown);
    CellDraft joined = opened;
    CellMembers reached = join_voids(task, joined, members);
    const auto is_reached = [&](std::uint32_t i) {
      return std::binary_search(reached.begin(), reached.end(), i);
    };
    bool has_two = !needs_high || (has_high && is_reached(opened.holes.back()->hole.from));
    if (!has_two) {
      if (has_high) joined.holes.pop_back();
      has_two = open_above(task, joined, reached);
    }
    const double volume = has_two ? volume_of(task, reached) : 0;
    if (volume > most) {
      most = volume;
      CellMembers unreached = members;
      std::erase_if(unreached, is_reached);
      leave_out(task, joined, unreached, &UndrainedVoids::unreached);
      best = std::move(joined);
    }
    if (is_asked_for_below || volume >= kEnoughReached * volume_of(task, members)) break;
    std::erase(candidates, low);
  }
  return best;
}

}  // namespace

CellDraft rejoin(const CellDrainageTask& task, CellDraft draft) {
  Passages passages = passages_of(task, draft);
  const std::size_t placed = passages.size();
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t window = 0; window < task.windows.size(); ++window) {
    if (!is_open(task, draft, window)) continue;
    candidates.push_back(window);
    passages.push_back(&task.windows[window].passage);
  }
  const auto accept = [&](std::size_t passage, bool reaches_a_void) {
    if (passage < placed) return true;
    const std::uint32_t window = candidates[passage - placed];
    if (!reaches_a_void || !is_open(task, draft, window)) return false;
    draft.windows.push_back(window);
    return true;
  };
  task.pools.flood(passages, kUpright, accept);
  return draft;
}

CellDraft begin_draft(const CellDrainageTask& task) {
  CellDraft draft{.is_kept = std::vector<char>(task.void_count(), 1),
                  .windows = {},
                  .holes = {},
                  .asked_for = {},
                  .dropped = {}};
  if (task.request.escape_holes.size() >= 2) return draft;
  std::vector<char> has_window(task.void_count(), 0);
  for (const CellWindow& window : task.windows)
    has_window[window.channel.from] = has_window[window.channel.to] = 1;
  CellMembers narrow;
  for (std::uint32_t i = 0; i < task.void_count(); ++i) {
    if (has_window[i] == 0 && task.hollows[i].volume() < kLeastNetworkShare * task.volume)
      narrow.push_back(i);
  }
  leave_out(task, draft, narrow, &UndrainedVoids::narrow);
  return draft;
}

CellDraft open_where_asked(CellDrainageTask& task, CellDraft draft) {
  CellMembers all;
  for (std::uint32_t i = 0; i < task.void_count(); ++i) {
    if (draft.is_kept[i] != 0) all.push_back(i);
  }
  const auto hole_at = [&](Vec3d place) {
    task.monitor.check_interrupted();
    std::optional<CellHole> hole;
    for (const CellHolePlaces& places : task.places) {
      if (hole) break;
      hole = places.leading_to(place, all,
                               [&](const CellHole& candidate) { return can_place(task, draft, candidate); });
    }
    return hole;
  };
  open_at_each(task.request.escape_holes, [&](Vec3d place) {
    auto hole = hole_at(place);
    if (!hole)
      throw no_hole_leads_from(
          place,
          nearest_place(place, longest_hole(task.request, task.limits), task.surfaces.model(),
                        [&](Vec3d at) { return hole_at(at).has_value(); }),
          task.request);
    draft.asked_for.push_back(hole->hole.from);
    draft.holes.push_back(std::make_shared<const CellHole>(std::move(*hole)));
  });
  return draft;
}

CellDraft open_and_join(CellDrainageTask& task, CellDraft draft) {
  for (const CellMembers& members : networks_of(task, draft)) {
    task.monitor.check_interrupted();
    const bool is_asked_for = !holes_of(draft, members).empty();
    const bool is_worth_it = is_asked_for || (task.request.escape_holes.size() < 2 &&
                                              volume_of(task, members) >= kLeastNetworkShare * task.volume);
    const std::size_t windows = draft.windows.size(), holes = draft.holes.size();
    if (is_worth_it) draft = open_network(task, draft, members);
    const bool is_opened =
        draft.holes.size() > holes || draft.windows.size() > windows || holes_of(draft, members).size() >= 2;
    if (!is_opened) leave_out(task, draft, members, &UndrainedVoids::unopened);
  }
  return draft;
}

}  // namespace aerate
