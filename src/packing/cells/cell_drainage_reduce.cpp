#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "kernels/constants.h"
#include "packing/cells/cell_drainage_stages.h"

namespace aerate {
namespace {

// Pools for which a place is looked for before none is found to be worth it.
constexpr int kMostPoolsTried = 6;

// Windows beside the tree, and holes, lower what stays by this share of the volume, or are not made.
constexpr double kLeastGain = 0.0005;
constexpr int kMostRoundsOfWindows = 8;

// Voids of which it is tried what is gained if one is left out.
constexpr std::size_t kMostLeftOutTried = 8;

bool is_good(const TrappedPools& pools) {
  return pools.after_both <= kPoolsAimedAt * pools.total;
}

// Marks the windows on the ways along which hollows that hold liquid would drain lower, if all windows were
// there that are clear of what is placed.
void mark_ways(const CellDrainageTask& task, const CellDraft& draft, std::size_t orientation,
               std::vector<char>& is_wanted) {
  const HollowFlood now = task.pools.flood(passages_of(task, draft), orientation);
  Passages all = passages_of(task, draft);
  const std::size_t placed = all.size();
  std::vector<std::uint32_t> more;
  for (std::uint32_t window = 0; window < task.windows.size(); ++window) {
    if (!is_open(task, draft, window)) continue;
    more.push_back(window);
    all.push_back(&task.windows[window].passage);
  }
  const HollowFlood ideal = task.pools.flood(all, orientation);
  const std::uint32_t hollows = task.pools.hollow_count(orientation);
  std::vector<char> is_followed(ideal.height.size(), 0);
  for (std::uint32_t i = 0; i < task.void_count(); ++i) {
    if (draft.is_kept[i] == 0) continue;
    for (const VoidHollows::Piece& piece : task.hollows[i].pieces()) {
      const std::uint32_t hollow = orientation == kUpright ? piece.upright : piece.upside_down;
      std::uint32_t at = task.pools.vertex(i, hollow, orientation);
      const double gain =
          piece_below(piece, orientation, now.height[at]) - piece_below(piece, orientation, ideal.height[at]);
      if (gain < kLeastGain / 10 * task.volume) continue;
      for (; at != kNone && is_followed[at] == 0; at = ideal.towards[at]) {
        is_followed[at] = 1;
        if (at >= hollows + placed) is_wanted[more[at - hollows - placed]] = 1;
      }
    }
  }
}

CellDraft with_wanted(const CellDrainageTask& task, const CellDraft& draft,
                      const std::vector<char>& is_wanted) {
  CellDraft with_more = draft;
  for (std::uint32_t window = 0; window < task.windows.size(); ++window) {
    if (is_wanted[window] != 0 && is_open(task, with_more, window)) with_more.windows.push_back(window);
  }
  return with_more;
}

// Without those of the windows from `first` on that do no good.
CellDraft without_useless(CellDrainageTask& task, CellDraft draft, std::size_t first) {
  for (std::size_t i = draft.windows.size(); i-- > first;) {
    task.monitor.check_interrupted();
    const TrappedPools with = pools_of(task, draft);
    CellDraft fewer = draft;
    fewer.windows.erase(fewer.windows.begin() + static_cast<std::ptrdiff_t>(i));
    const TrappedPools without = pools_of(task, fewer);
    if (is_good(without) || without.after_both <= with.after_both + 1e-6) draft = std::move(fewer);
  }
  return draft;
}

struct TriedPool {
  Basin basin;
  std::size_t orientation;
};

// Pools of both orientations: those of the one in which less stays, then of the other; the largest first.
std::vector<TriedPool> largest_pools(const CellDrainageTask& task, const CellDraft& draft) {
  std::vector<TriedPool> pools;
  const Passages passages = passages_of(task, draft);
  const TrappedPools all = pools_of(task, draft);
  const std::size_t first = all.upright <= all.upside_down ? kUpright : kUpsideDown;
  for (const std::size_t orientation : {first, 1 - first}) {
    const HollowFlood flood = task.pools.flood(passages, orientation);
    for (Basin& basin : task.pools.basins(flood, orientation, draft.is_kept)) {
      if (basin.volume >= kPoolWorthHole * task.volume) pools.push_back({std::move(basin), orientation});
    }
  }
  return pools;
}

// A draft with one more hole that is worth it.
std::optional<CellDraft> with_one_more_hole(CellDrainageTask& task, const CellDraft& draft) {
  const double before = pools_of(task, draft).after_both;
  int tries = 0;
  for (const TriedPool& pool : largest_pools(task, draft)) {
    if (++tries > kMostPoolsTried) break;
    CellDraft opened = draft;
    if (!open_hollows(task, opened, pool.basin.hollows, pool.orientation)) continue;
    const double gain = before - pools_of(task, opened).after_both;
    if (gain >= kLeastGain * task.volume) return opened;
  }
  return std::nullopt;
}

// Voids that no window joins to a hole any more are joined by others, or left out with it.
CellDraft without(const CellDrainageTask& task, CellDraft draft, std::uint32_t void_index,
                  bool joins_others) {
  leave_out(task, draft, {void_index}, &UndrainedVoids::full);
  if (joins_others) draft = rejoin(task, std::move(draft));
  for (const CellMembers& part : parts_of(task, draft)) {
    if (holes_of(draft, part).empty()) leave_out(task, draft, part, &UndrainedVoids::full);
  }
  return draft;
}

// Gives each part a second hole, since leaving out may have cut some in two, or leaves it out.
CellDraft open_parts(CellDrainageTask& task, CellDraft draft) {
  for (const CellMembers& part : parts_of(task, draft)) {
    for (std::size_t holes = holes_of(draft, part).size(); holes < 2; ++holes) {
      if (open_voids(task, draft, part, kUpsideDown) || open_voids(task, draft, part, kUpright)) continue;
      leave_out(task, draft, part, &UndrainedVoids::unopened);
      break;
    }
  }
  return draft;
}

// The draft without the void that costs the least volume for what stays less without it; nullopt if none is
// worth it.
std::optional<CellDraft> without_fullest(CellDrainageTask& task, const CellDraft& draft) {
  const TrappedPools pools = pools_of(task, draft);
  // The orientation in which less stays says where that is.
  const std::size_t orientation = pools.upright <= pools.upside_down ? kUpright : kUpsideDown;
  const HollowFlood flood = task.pools.flood(passages_of(task, draft), orientation);
  const std::vector<double> stays_in = task.pools.stays_in(flood, orientation);
  std::vector<std::pair<double, std::uint32_t>> candidates;
  for (std::uint32_t i = 0; i < task.void_count(); ++i) {
    const bool is_asked_for =
        std::find(draft.asked_for.begin(), draft.asked_for.end(), i) != draft.asked_for.end();
    const double volume = task.hollows[i].volume();
    if (draft.is_kept[i] != 0 && !is_asked_for && stays_in[i] > kPoolsAimedAt * volume)
      candidates.emplace_back(-stays_in[i] / volume, i);
  }
  std::sort(candidates.begin(), candidates.end());
  if (candidates.size() > kMostLeftOutTried) candidates.resize(kMostLeftOutTried);
  std::optional<CellDraft> best;
  double most = kPoolsAimedAt;  // of what is left out less than this stayed
  for (const auto& [share, i] : candidates) {
    for (const bool joins_others : {true, false}) {
      task.monitor.check_interrupted();
      CellDraft fewer = without(task, draft, i, joins_others);
      const double lost = fewer.dropped.volume - draft.dropped.volume;
      const double gain = (pools.after_both - pools_of(task, fewer).after_both) / lost;
      if (gain <= most) continue;
      most = gain;
      best = std::move(fewer);
    }
  }
  return best;
}

}  // namespace

CellDraft with_windows_that_lower(const CellDrainageTask& task, const CellDraft& draft,
                                  std::size_t orientation) {
  std::vector<char> is_wanted(task.windows.size(), 0);
  mark_ways(task, draft, orientation, is_wanted);
  return with_wanted(task, draft, is_wanted);
}

CellDraft add_windows_for_pools(CellDrainageTask& task, CellDraft draft) {
  const std::size_t first = draft.windows.size();
  for (int round = 0; round < kMostRoundsOfWindows; ++round) {
    const TrappedPools before = pools_of(task, draft);
    if (is_good(before)) break;
    std::array<std::vector<char>, 2> wanted;
    for (const std::size_t orientation : {kUpright, kUpsideDown}) {
      task.monitor.check_interrupted();
      wanted[orientation].assign(task.windows.size(), 0);
      mark_ways(task, draft, orientation, wanted[orientation]);
    }
    std::vector<char> both = wanted[kUpright];
    for (std::size_t i = 0; i < both.size(); ++i)
      both[i] = both[i] != 0 || wanted[kUpsideDown][i] != 0 ? 1 : 0;
    CellDraft best = draft;
    double least = before.after_both - kLeastGain * task.volume;
    for (const std::vector<char>& set : {wanted[kUpright], wanted[kUpsideDown], both}) {
      CellDraft with_more = with_wanted(task, draft, set);
      const double left = pools_of(task, with_more).after_both;
      if (left >= least) continue;
      least = left;
      best = std::move(with_more);
    }
    if (best.windows.size() == draft.windows.size()) break;
    draft = std::move(best);
  }
  return without_useless(task, std::move(draft), first);
}

CellDraft open_pools(CellDrainageTask& task, CellDraft draft) {
  for (int more = 0; more < kMostMoreHoles; ++more) {
    if (is_good(pools_of(task, draft))) break;
    auto opened = with_one_more_hole(task, draft);
    if (!opened) break;
    draft = std::move(*opened);
  }
  return draft;
}

CellDraft leave_out_pools(CellDrainageTask& task, CellDraft draft) {
  while (true) {
    while (!is_good(pools_of(task, draft))) {
      auto fewer = without_fullest(task, draft);
      if (!fewer) break;
      draft = std::move(*fewer);
    }
    const std::size_t before = draft.dropped.count();
    draft = open_parts(task, std::move(draft));
    if (draft.dropped.count() == before) return draft;
  }
}

}  // namespace aerate
