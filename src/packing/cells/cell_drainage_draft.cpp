#include "packing/cells/cell_drainage_draft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <tbb/parallel_for.h>
#include <utility>

#include "core/disjoint_sets.h"
#include "core/segment_distance.h"
#include "kernels/constants.h"
#include "packing/hole_rules.h"
#include "packing/placed_tubes.h"

namespace aerate {
namespace {

// Above that nodes are put together, two by two by two.
constexpr double kMostNodes = 5e6;
constexpr int kMostHalvings = 5;

// For one hole, places that turn out not to be cut well before it is given up; and shares of the height of
// the voids in which it is looked for, one after the other.
constexpr int kMostCuts = 100;
constexpr std::array<double, 2> kSharesOfHeight{0.3, 1};

std::vector<VoidHollows> hollows_of(const CellVoids& cells, Vec3d up, Monitor& monitor) {
  double nodes = 0;
  for (const CellVoid& one : cells.voids) {
    for (const NodeRun& run : one.nodes) nodes += run.last - run.first + 1;
  }
  int halvings = 0;
  for (; nodes > kMostNodes && halvings < kMostHalvings; nodes /= 8) ++halvings;
  std::vector<std::optional<VoidHollows>> grown(cells.voids.size());
  monitor.check_interrupted();
  tbb::parallel_for(std::size_t{0}, grown.size(), [&](std::size_t i) {
    const CellVoid& one = cells.voids[i];
    grown[i].emplace(nodes_of(one, cells.lattice, halvings), up, std::abs(signed_volume(one.surface)),
                     one.surface);
  });
  monitor.check_interrupted();
  std::vector<VoidHollows> hollows;
  hollows.reserve(grown.size());
  for (std::optional<VoidHollows>& one : grown) hollows.push_back(std::move(*one));
  return hollows;
}

}  // namespace

CellDrainageGround::CellDrainageGround(const DrainableModel& drained, const CellVoids& voids,
                                       const PackingLimits& kept, const DrainageRequest& request,
                                       Monitor& monitor)
    : model(drained),
      cells(voids),
      limits(kept),
      hollows(hollows_of(voids, kept.roof.up, monitor)),
      pools(hollows),
      surfaces(model.surface, voids, kept, 2 * longest_hole(request, kept), model.kept),
      windows(find_cell_windows(voids, hollows, kept, request.channel_radius, surfaces, monitor)) {
  for (const double radius : {request.hole_radius, request.narrow_hole_radius})
    if (radius > 0) ways.emplace_back(model, voids, hollows, kept, radius, surfaces, request.sides);
  for (const VoidHollows& one : hollows) volume += one.volume();
}

CellDrainageTask::CellDrainageTask(CellDrainageGround& ground, const DrainageRequest& asked,
                                   const CanOpenCell& can_cut, const CanOpenWall& can_cut_wall,
                                   Monitor& watched)
    : cells(ground.cells),
      limits(ground.limits),
      request(asked),
      can_open(can_cut),
      monitor(watched),
      hollows(ground.hollows),
      volume(ground.volume),
      pools(ground.pools),
      surfaces(ground.surfaces) {
  std::ranges::copy_if(ground.windows, std::back_inserter(windows),
                       [&](const CellWindow& window) { return can_cut_wall(window.channel.tube); });
  for (CellHoleWays& ways : ground.ways)
    places.emplace_back(ground.model, cells, hollows, limits, asked, surfaces, ways);
}

double volume_of(const CellDrainageTask& task, const CellMembers& members) {
  double volume = 0;
  for (const std::uint32_t i : members) volume += task.hollows[i].volume();
  return volume;
}

bool keeps_clear(const CellDrainageTask& task, const CellDraft& draft, const Tube& tube, std::uint32_t from,
                 std::uint32_t to) {
  const double tube_length = length(tube.end - tube.start);
  const auto is_clear_of = [&](const Tube& other, std::uint32_t other_from, std::uint32_t other_to) {
    const bool meet = other_from == from || other_from == to || other_to == from || other_to == to;
    const double openings = tube_spacing(tube.radius, other.radius);
    const double spacing = meet ? openings : std::max(openings, tube.radius + other.radius + task.limits.gap);
    // Most are so far off that one end of each tells.
    if (length(other.start - tube.start) > spacing + tube_length + length(other.end - other.start))
      return true;
    return distance_between({tube.start, tube.end}, {other.start, other.end}) >= spacing;
  };
  return std::all_of(draft.windows.begin(), draft.windows.end(),
                     [&](std::uint32_t window) {
                       const Channel& channel = task.windows[window].channel;
                       return is_clear_of(channel.tube, channel.from, channel.to);
                     }) &&
         std::all_of(draft.holes.begin(), draft.holes.end(), [&](const auto& hole) {
           return is_clear_of(hole->hole.tube, hole->hole.from, hole->hole.from);
         });
}

bool is_open(const CellDrainageTask& task, const CellDraft& draft, std::uint32_t window) {
  const Channel& channel = task.windows[window].channel;
  return draft.is_kept[channel.from] != 0 && draft.is_kept[channel.to] != 0 &&
         keeps_clear(task, draft, channel.tube, channel.from, channel.to);
}

void leave_out(const CellDrainageTask& task, CellDraft& draft, const CellMembers& members,
               std::size_t UndrainedVoids::*reason) {
  for (const std::uint32_t i : members) {
    if (draft.is_kept[i] == 0) continue;
    draft.is_kept[i] = 0;
    ++(draft.dropped.*reason);
    draft.dropped.volume += task.hollows[i].volume();
  }
  std::erase_if(draft.windows, [&](std::uint32_t window) {
    const Channel& channel = task.windows[window].channel;
    return draft.is_kept[channel.from] == 0 || draft.is_kept[channel.to] == 0;
  });
  std::erase_if(draft.holes, [&](const auto& hole) { return draft.is_kept[hole->hole.from] == 0; });
}

std::vector<CellMembers> parts_of(const CellDrainageTask& task, const CellDraft& draft) {
  DisjointSets sets(task.void_count());
  for (const std::uint32_t window : draft.windows)
    sets.join(task.windows[window].channel.from, task.windows[window].channel.to);
  std::vector<std::uint32_t> number(task.void_count(), kNone);
  std::vector<CellMembers> parts;
  for (std::uint32_t i = 0; i < task.void_count(); ++i) {
    if (draft.is_kept[i] == 0) continue;
    std::uint32_t& own = number[sets.root(i)];
    if (own == kNone) {
      own = static_cast<std::uint32_t>(parts.size());
      parts.emplace_back();
    }
    parts[own].push_back(i);
  }
  return parts;
}

std::vector<std::uint32_t> holes_of(const CellDraft& draft, const CellMembers& members) {
  std::vector<std::uint32_t> holes;
  for (std::uint32_t i = 0; i < draft.holes.size(); ++i) {
    if (std::binary_search(members.begin(), members.end(), draft.holes[i]->hole.from)) holes.push_back(i);
  }
  return holes;
}

bool can_place(CellDrainageTask& task, const CellDraft& draft, const CellHole& hole) {
  task.monitor.check_interrupted();
  const EscapeHole& escape = hole.hole;
  if (!keeps_clear(task, draft, escape.tube, escape.from, escape.from)) return false;
  const bool is_beside_uncut =
      std::any_of(task.uncut.begin(), task.uncut.end(), [&](const EscapeHole& uncut) {
        return uncut.from == escape.from && escape.tube.radius >= uncut.tube.radius &&
               length(uncut.tube.end - escape.tube.end) < escape.tube.radius;
      });
  if (is_beside_uncut) return false;
  if (task.can_open(escape.tube, escape.from)) return true;
  task.uncut.push_back(escape);
  return false;
}

bool open_hollows(CellDrainageTask& task, CellDraft& draft, std::span<const Basin::Part> hollows,
                  std::size_t orientation) {
  for (CellHolePlaces& places : task.places) {
    for (const double share : kSharesOfHeight) {
      const std::size_t known = task.uncut.size();
      bool is_given_up = false;
      auto hole = places.best(hollows, orientation, share, [&](const CellHole& candidate) {
        is_given_up = task.uncut.size() >= known + kMostCuts;
        return is_given_up || can_place(task, draft, candidate);
      });
      if (!hole || is_given_up) continue;
      draft.holes.push_back(std::make_shared<const CellHole>(std::move(*hole)));
      return true;
    }
  }
  return false;
}

bool open_voids(CellDrainageTask& task, CellDraft& draft, const CellMembers& voids, std::size_t orientation) {
  std::vector<Basin::Part> hollows;
  for (const std::uint32_t i : voids) {
    for (std::uint32_t hollow = 0; hollow < task.hollows[i].in(orientation).size(); ++hollow)
      hollows.push_back({i, hollow});
  }
  return open_hollows(task, draft, hollows, orientation);
}

Passages passages_of(const CellDrainageTask& task, const CellDraft& draft) {
  Passages passages;
  for (const std::uint32_t window : draft.windows) passages.push_back(&task.windows[window].passage);
  for (const auto& hole : draft.holes) passages.push_back(&hole->passage);
  return passages;
}

TrappedPools pools_of(const CellDrainageTask& task, const CellDraft& draft) {
  TrappedPools pools = task.pools.measure(passages_of(task, draft), draft.is_kept);
  for (const std::uint32_t window : draft.windows) {
    const CellWindow& own = task.windows[window];
    pools.total += std::numbers::pi * own.channel.tube.radius * own.channel.tube.radius *
                   length(own.wall.end - own.wall.start);
  }
  return pools;
}

PlannedCellDrainage planned(const CellDrainageTask& task, const CellDraft& draft) {
  PlannedCellDrainage result{.kept = {}, .plan = {}, .dropped = draft.dropped};
  result.plan.roof = task.limits.roof;
  std::vector<std::uint32_t> renumbered(task.void_count(), kNone);
  for (std::uint32_t i = 0; i < task.void_count(); ++i) {
    if (draft.is_kept[i] == 0) continue;
    renumbered[i] = static_cast<std::uint32_t>(result.kept.size());
    result.kept.push_back(i);
  }
  for (const std::uint32_t window : draft.windows) {
    const Channel& channel = task.windows[window].channel;
    result.plan.channels.push_back({renumbered[channel.from], renumbered[channel.to], channel.tube});
  }
  const std::vector<CellMembers> parts = parts_of(task, draft);
  std::vector<std::uint32_t> part_of(task.void_count(), kNone);
  for (std::uint32_t part = 0; part < parts.size(); ++part) {
    for (const std::uint32_t i : parts[part]) part_of[i] = part;
  }
  for (const auto& hole : draft.holes) {
    const std::uint32_t from = hole->hole.from;
    result.plan.holes.push_back({renumbered[from], hole->hole.tube, part_of[from], hole->hole.purpose});
  }
  result.plan.network_count = parts.size();
  result.plan.pools = pools_of(task, draft);
  return result;
}

}  // namespace aerate
