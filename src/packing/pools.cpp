#include "packing/pools.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <queue>
#include <tbb/parallel_invoke.h>
#include <tuple>
#include <utility>
#include <vector>

#include "kernels/constants.h"

namespace aerate {
namespace {

constexpr int kSlices = 64;

// Area of the part of a circle below a line at signed distance `level` from its centre.
double segment_area(double radius, double level) {
  if (level <= -radius) return 0;
  if (level >= radius) return std::numbers::pi * radius * radius;
  return radius * radius * std::acos(-level / radius) + level * std::sqrt(radius * radius - level * level);
}

// Volume of a tube below a height along `up`, in slices across its axis.
double tube_volume_below(const Tube& tube, Vec3d up, double height) {
  const Vec3d along = tube.end - tube.start;
  const double whole = length(along);
  const double rise = dot(along, up) / whole;
  const double tilt = std::sqrt(std::max(0.0, 1 - rise * rise));
  double area = 0;
  for (int i = 0; i < kSlices; ++i) {
    const double middle = dot(tube.start + along * ((i + 0.5) / kSlices), up);
    const double above = height - middle;
    const bool upright = tilt * tube.radius < 1e-9;
    area += upright ? (above > 0 ? std::numbers::pi * tube.radius * tube.radius : 0.0)
                    : segment_area(tube.radius, std::clamp(above / tilt, -tube.radius, tube.radius));
  }
  return area * whole / kSlices;
}

// What stays in one orientation, by void and by channel, mm3.
struct Pools {
  std::vector<double> of_void, of_channel;

  double sum() const {
    double total = 0;
    for (const double volume : of_void) total += volume;
    for (const double volume : of_channel) total += volume;
    return total;
  }
};

Pools find_pools(std::span<const VoidShape> voids, const DrainagePlan& plan, const SpillHeights& spills,
                 Vec3d up) {
  Pools pools;
  for (std::size_t i = 0; i < voids.size(); ++i)
    pools.of_void.push_back(voids[i].volume_below(up, spills.height[i]));
  for (std::size_t i = 0; i < plan.channels.size(); ++i) {
    const Channel& channel = plan.channels[i];
    const double through_start = std::max(spills.floors[i][0], spills.height[channel.from]);
    const double through_end = std::max(spills.floors[i][1], spills.height[channel.to]);
    pools.of_channel.push_back(tube_volume_below(channel.tube, up, std::min(through_start, through_end)));
  }
  return pools;
}

// What stays of the pools `left` when it runs out along `spills` and may fill `room` on its way.
double retained(const Pools& left, const Pools& room, const DrainagePlan& plan, const SpillHeights& spills) {
  std::vector<double> inflow = left.of_void;
  std::vector<double> capacity = room.of_void;
  double stays = 0;
  for (std::size_t i = 0; i < plan.channels.size(); ++i) {
    inflow[plan.channels[i].from] += left.of_channel[i];
    inflow[plan.channels[i].to] += left.of_channel[i];
    stays += std::min(left.of_channel[i], room.of_channel[i]);
  }
  // Voids of one spill height along a way out are one basin.
  for (auto at = spills.order.rbegin(); at != spills.order.rend(); ++at) {
    const std::uint32_t next = spills.towards[*at];
    if (next != kNone && spills.height[next] == spills.height[*at]) {
      inflow[next] += inflow[*at];
      capacity[next] += capacity[*at];
      continue;
    }
    const double stays_here = std::min(inflow[*at], capacity[*at]);
    stays += stays_here;
    if (next != kNone) inflow[next] += inflow[*at] - stays_here;
  }
  for (std::size_t i = 0; i < inflow.size(); ++i) {
    if (spills.height[i] == kInfinity) stays += inflow[i];
  }
  return stays;
}

}  // namespace

double sill_of(const Tube& tube, const VoidShape& from, const VoidShape& to, Vec3d up) {
  return std::max(from.opening_floor(tube, TubeEnd::start, up), to.opening_floor(tube, TubeEnd::end, up));
}

double sill_of_hole(const EscapeHole& hole, const VoidShape& from, Vec3d up) {
  const Vec3d along = hole.tube.end - hole.tube.start;
  const double rise = dot(along, up) / length(along);
  const double outside =
      dot(hole.tube.end, up) - hole.tube.radius * std::sqrt(std::max(0.0, 1 - rise * rise));
  return std::max(from.opening_floor(hole.tube, TubeEnd::start, up), outside);
}

SpillHeights spill_heights(std::span<const VoidShape> voids, const DrainagePlan& plan, Vec3d up) {
  SpillHeights spills;
  std::vector<std::vector<std::pair<std::uint32_t, double>>> ways(voids.size());
  for (const Channel& channel : plan.channels) {
    const double start = voids[channel.from].opening_floor(channel.tube, TubeEnd::start, up);
    const double end = voids[channel.to].opening_floor(channel.tube, TubeEnd::end, up);
    spills.floors.push_back({start, end});
    ways[channel.from].push_back({channel.to, std::max(start, end)});
    ways[channel.to].push_back({channel.from, std::max(start, end)});
  }
  spills.height.assign(voids.size(), kInfinity);
  spills.towards.assign(voids.size(), kNone);
  using Step = std::tuple<double, std::uint32_t, std::uint32_t>;  // height, void, towards
  std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
  for (const EscapeHole& hole : plan.holes)
    open.push({sill_of_hole(hole, voids[hole.from], up), hole.from, kNone});
  std::vector<bool> done(voids.size(), false);
  while (!open.empty()) {
    const auto [height, at, towards] = open.top();
    open.pop();
    if (done[at]) continue;
    done[at] = true;
    spills.height[at] = height;
    spills.towards[at] = towards;
    spills.order.push_back(at);
    for (const auto& [next, sill] : ways[at]) {
      if (!done[next]) open.push({std::max(height, sill), next, at});
    }
  }
  return spills;
}

std::vector<Pool> upright_pools(std::span<const VoidShape> voids, const DrainagePlan& plan) {
  const SpillHeights spills = spill_heights(voids, plan, plan.roof.up);
  std::vector<std::uint32_t> root_of(voids.size(), kNone);
  std::map<std::uint32_t, Pool> pool_of;
  for (const std::uint32_t i : spills.order) {
    const std::uint32_t next = spills.towards[i];
    root_of[i] = next != kNone && spills.height[next] == spills.height[i] ? root_of[next] : i;
    Pool& pool = pool_of[root_of[i]];
    pool.volume += voids[i].volume_below(plan.roof.up, spills.height[i]);
    pool.voids.push_back(i);
  }
  std::vector<Pool> pools;
  pools.reserve(pool_of.size());
  for (auto& [root, pool] : pool_of) pools.push_back(std::move(pool));
  std::stable_sort(pools.begin(), pools.end(),
                   [](const Pool& a, const Pool& b) { return a.volume > b.volume; });
  return pools;
}

std::vector<std::uint32_t> branch_of(std::uint32_t root, const SpillHeights& spills) {
  std::vector<std::uint32_t> branch;
  std::vector<bool> is_in_branch(spills.towards.size(), false);
  for (const std::uint32_t i : spills.order) {
    const std::uint32_t next = spills.towards[i];
    if (i != root && (next == kNone || !is_in_branch[next])) continue;
    is_in_branch[i] = true;
    branch.push_back(i);
  }
  return branch;
}

std::uint32_t fullest_branch(std::span<const VoidShape> voids, const DrainagePlan& plan,
                             const SpillHeights& spills, std::span<const std::uint32_t> kept, double least) {
  std::vector<double> whole(voids.size(), 0), full(voids.size(), 0);
  for (const std::uint32_t i : spills.order) {
    whole[i] = voids[i].volume();
    full[i] = voids[i].volume_below(plan.roof.up, spills.height[i]);
  }
  std::vector<bool> has_hole(voids.size(), false), is_kept(voids.size(), false);
  for (const EscapeHole& hole : plan.holes) has_hole[hole.from] = true;
  for (const std::uint32_t i : kept) is_kept[i] = true;
  std::array<std::uint32_t, 2> worst{kNone, kNone};  // without a hole, and with one
  std::array<double, 2> most{least, least};
  for (auto at = spills.order.rbegin(); at != spills.order.rend(); ++at) {
    const std::uint32_t i = *at, next = spills.towards[*at];
    const std::size_t kind = has_hole[i] ? 1 : 0;
    if (!is_kept[i] && full[i] > most[kind] * whole[i]) {
      most[kind] = full[i] / whole[i];
      worst[kind] = i;
    }
    if (next == kNone) continue;
    whole[next] += whole[i];
    full[next] += full[i];
    has_hole[next] = has_hole[next] || has_hole[i];
    is_kept[next] = is_kept[next] || is_kept[i];
  }
  return worst[0] != kNone ? worst[0] : worst[1];
}

TrappedPools trapped_pools(std::span<const VoidShape> voids, const DrainagePlan& plan) {
  SpillHeights spills;
  Pools upright, turned;
  tbb::parallel_invoke(
      [&] {
        const SpillHeights upright_spills = spill_heights(voids, plan, plan.roof.up);
        upright = find_pools(voids, plan, upright_spills, plan.roof.up);
      },
      [&] {
        spills = spill_heights(voids, plan, -plan.roof.up);
        turned = find_pools(voids, plan, spills, -plan.roof.up);
      });
  TrappedPools pools;
  pools.upright = upright.sum();
  pools.upside_down = turned.sum();
  pools.after_both = std::min(pools.upright, retained(upright, turned, plan, spills));
  for (const VoidShape& shape : voids) pools.total += shape.volume();
  for (const Channel& channel : plan.channels) {
    pools.total += std::numbers::pi * channel.tube.radius * channel.tube.radius *
                   length(channel.tube.end - channel.tube.start);
  }
  return pools;
}

double widest_cup(std::span<const VoidShape> voids, const DrainagePlan& plan) {
  const SpillHeights spills = spill_heights(voids, plan, plan.roof.up);
  double widest = 0;
  for (std::size_t i = 0; i < voids.size(); ++i) {
    if (spills.height[i] == kInfinity) continue;
    const double radius = voids[i].radius();
    const double below = std::clamp(dot(voids[i].centre(), plan.roof.up) - spills.height[i], 0.0, radius);
    widest = std::max(widest, std::numbers::pi * (radius * radius - below * below));
  }
  return widest;
}

}  // namespace aerate
