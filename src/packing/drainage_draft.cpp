#include "packing/drainage_draft.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <map>

#include "kernels/constants.h"

namespace aerate {
namespace {

// No channel is longer than the largest void's radius, or this many channel diameters.
constexpr double kLongestInDiameters = 4;

// Sound places where the surface turned out not to be cut well, for one escape hole, before it is given up:
// first in this share of the network's height, then anywhere.
constexpr int kMostCuts = 100;
constexpr std::array<double, 2> kSharesOfHeight{0.3, 1};

double longest_channel_between(std::span<const VoidShape> voids, const DrainageRequest& request) {
  double longest = kLongestInDiameters * 2 * request.channel_radius;
  for (const VoidShape& shape : voids) longest = std::max(longest, shape.radius());
  return longest;
}

// `next` gives holes one by one, the best first; nullopt when there are no more.
std::optional<EscapeHole> first_of(DrainageTask& task, const PlacedTubes& tubes,
                                   const std::function<std::optional<EscapeHole>()>& next) {
  int cuts = 0;
  while (auto hole = next()) {
    task.monitor.check_interrupted();
    if (!tubes.keep_clear_of(hole->tube, hole->from, hole->from) || !task.places.is_sound(*hole)) continue;
    const Vec3d end = hole->tube.end;
    const std::tuple place{hole->from, end.x, end.y, end.z};
    if (task.uncut.contains(place)) continue;
    if (++cuts > kMostCuts) return std::nullopt;
    if (task.can_open(*hole)) return hole;
    task.uncut.insert(place);
  }
  return std::nullopt;
}

}  // namespace

DrainageTask::DrainageTask(const DrainableModel& model, const Packing& packing, const DrainageRequest& asked,
                           const CanOpen& can_cut, Monitor& watched)
    : request(asked),
      can_open(can_cut),
      monitor(watched),
      limits(packing.limits),
      voids(shapes_of(packing.spheres, limits.roof)),
      longest_channel(longest_channel_between(voids, request)),
      no_tubes(limits.roof, limits.gap, std::max(longest_channel, longest_hole(request, limits)),
               std::max(request.channel_radius, request.hole_radius)),
      clearance(model.surface, packing, std::max(longest_channel, longest_hole(request, limits)),
                std::max(request.channel_radius, request.hole_radius), model.kept),
      ways(voids, limits.roof, request.channel_radius, longest_channel, clearance, monitor),
      places(model, voids, limits, request, clearance) {
  for (const VoidShape& shape : voids)
    volume += shape.takes_tube(request.channel_radius) ? shape.volume() : 0;
}

double volume_of(const DrainageTask& task, const Members& members) {
  double volume = 0;
  for (const std::uint32_t i : members) volume += task.voids[i].volume();
  return volume;
}

void leave_out(const DrainageTask& task, Draft& draft, const Members& members,
               std::size_t UndrainedVoids::*reason) {
  for (const std::uint32_t i : members) {
    draft.network_of[i] = kNone;
    ++(draft.dropped.*reason);
    draft.dropped.volume += task.voids[i].volume();
  }
  draft.tubes.remove_tubes_of([&](std::uint32_t i) { return draft.network_of[i] == kNone; });
}

std::ptrdiff_t hole_count(const Draft& draft, std::uint32_t network) {
  const std::vector<EscapeHole>& holes = draft.tubes.plan().holes;
  return std::count_if(holes.begin(), holes.end(),
                       [&](const EscapeHole& hole) { return draft.network_of[hole.from] == network; });
}

bool has_low_hole(const DrainageTask& task, const Draft& draft, const Members& members) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const std::uint32_t i : members) {
    lowest = std::min(lowest, task.voids[i].bottom(task.up()));
    highest = std::max(highest, -task.voids[i].bottom(-task.up()));
  }
  const std::uint32_t network = draft.network_of[members.front()];
  const std::vector<EscapeHole>& holes = draft.tubes.plan().holes;
  return hole_count(draft, network) >= 2 ||
         std::any_of(holes.begin(), holes.end(), [&](const EscapeHole& hole) {
           return draft.network_of[hole.from] == network &&
                  dot(hole.tube.end, task.up()) < (lowest + highest) / 2;
         });
}

bool is_open(DrainageTask& task, const PlacedTubes& tubes, std::size_t way) {
  task.monitor.check_interrupted();
  const Channel& channel = task.ways[way].channel;
  return task.ways.is_free(way) && tubes.keep_clear_of(channel.tube, channel.from, channel.to);
}

std::optional<EscapeHole> first_that_opens(DrainageTask& task, const PlacedTubes& tubes,
                                           std::span<const EscapeHole> holes) {
  auto next = holes.begin();
  return first_of(task, tubes, [&] { return next == holes.end() ? std::nullopt : std::optional(*next++); });
}

bool open(DrainageTask& task, Draft& draft, const Members& voids, Vec3d down) {
  for (const double share : kSharesOfHeight) {
    HolePlaces::Ranking ranking = task.places.ranked(voids, down, share);
    const auto hole = first_of(task, draft.tubes, [&] { return ranking.next(); });
    if (!hole) continue;
    draft.tubes.place(*hole);
    return true;
  }
  return false;
}

PlannedDrainage planned(const DrainageTask& task, const Draft& draft) {
  PlannedDrainage result{.kept = {}, .plan = draft.tubes.plan(), .dropped = draft.dropped};
  std::vector<VoidShape> kept;
  std::vector<std::uint32_t> renumbered(task.voids.size(), kNone);
  for (std::uint32_t i = 0; i < task.voids.size(); ++i) {
    if (draft.network_of[i] == kNone) continue;
    renumbered[i] = static_cast<std::uint32_t>(kept.size());
    result.kept.push_back(i);
    kept.push_back(task.voids[i]);
  }
  for (Channel& c : result.plan.channels) {
    c.from = renumbered[c.from];
    c.to = renumbered[c.to];
  }
  std::map<std::uint32_t, std::uint32_t> networks;
  for (EscapeHole& hole : result.plan.holes) {
    const auto number = static_cast<std::uint32_t>(networks.size());
    hole.network = networks.emplace(draft.network_of[hole.from], number).first->second;
    hole.from = renumbered[hole.from];
  }
  result.plan.network_count = networks.size();
  result.plan.pools = trapped_pools(kept, result.plan);
  return result;
}

}  // namespace aerate
