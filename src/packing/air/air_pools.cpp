#include "packing/air/air_pools.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <tuple>
#include <utility>

#include "kernels/constants.h"
#include "packing/air/air_hollows.h"
#include "packing/cells/cell_drainage_flow.h"

namespace aerate {

AirFlood flood(const AirColumns& columns, std::size_t orientation) {
  const std::size_t count = columns.spans.size();
  AirFlood result{std::vector<double>(count, kInfinity), std::vector<std::uint32_t>(count, kNone)};
  using Step = std::tuple<double, std::uint32_t, std::uint32_t>;  // height, span, towards
  std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (columns.spans[i].floor_in(orientation) == -kInfinity) open.push({-kInfinity, i, kNone});
  }
  std::vector<bool> is_done(count, false);
  while (!open.empty()) {
    const auto [height, at, towards] = open.top();
    open.pop();
    if (is_done[at]) continue;
    is_done[at] = true;
    result.height[at] = height;
    result.towards[at] = towards;
    for (const AirPassage& passage : columns.passages_of(at)) {
      if (is_done[passage.to]) continue;
      const double to = std::max(height, passage.sill_in(orientation));
      open.push({to, passage.to, at});
    }
  }
  return result;
}

double left_in(const AirColumns& columns, const AirFlood& flood, std::size_t orientation, std::uint32_t span,
               const AirPart& part) {
  const double level = flood.height[span];
  const double height = orientation == kUpright ? std::min(part.to, level) - part.from
                                                : part.to - std::max(part.from, -level);
  return columns.area() * std::max(0.0, height);
}

TrappedPools pools_in(const AirColumns& columns, const AirFloods& floods, const std::vector<AirPart>& parts,
                      std::size_t first) {
  const std::size_t then = 1 - first;
  const AirHollows hollows = hollows_of(columns, then);
  FreeFlow flow(hollows.parent.size());
  TrappedPools pools;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ways;
  const auto is_part = [&](std::uint32_t span) { return parts[span].to > parts[span].from; };
  std::vector<double> supply(hollows.parent.size(), 0), demand(hollows.parent.size(), 0);
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (!is_part(i)) continue;
    const double left = left_in(columns, floods.in(first), first, i, parts[i]);
    const double room = left_in(columns, floods.in(then), then, i, parts[i]);
    pools.total += columns.area() * (parts[i].to - parts[i].from);
    (first == kUpright ? pools.upright : pools.upside_down) += left;
    (first == kUpright ? pools.upside_down : pools.upright) += room;
    const std::uint32_t hollow = hollows.of_span[i], next = floods.in(then).towards[i];
    supply[hollow] += left;
    demand[hollow] += room;
    if (next != kNone && is_part(next) && hollows.of_span[next] != hollow)
      ways.emplace_back(hollow, hollows.of_span[next]);
    if (hollows.parent[hollow] != kNone) ways.emplace_back(hollows.parent[hollow], hollow);
  }
  std::sort(ways.begin(), ways.end());
  ways.erase(std::unique(ways.begin(), ways.end()), ways.end());
  for (const auto& [from, to] : ways) flow.connect(from, to);
  for (std::uint32_t i = 0; i < supply.size(); ++i) {
    flow.supply(i, supply[i]);
    flow.demand(i, demand[i]);
  }
  pools.after_both = std::min({pools.upright, pools.upside_down, flow.most()});
  return pools;
}

}  // namespace aerate
