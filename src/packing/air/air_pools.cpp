#include "packing/air/air_pools.h"

#include <algorithm>
#include <bitset>
#include <functional>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "core/disjoint_sets.h"
#include "kernels/constants.h"
#include "packing/cells/cell_drainage_flow.h"

namespace aerate {

namespace {

// Pools that are told apart; the rest count as one, which whoever comes to one of them may fill.
constexpr std::size_t kMostPools = 256;
using PoolSet = std::bitset<kMostPools>;

// Where liquid that runs down through the turned model can come to rest: in which of its pools, each of which holds no
// more than stays of it when it is full.
class TurnedOver {
 public:
  TurnedOver(const AirColumns& columns, const AirFlood& flood, const std::vector<AirPart>& parts)
      : columns_(columns), flood_(flood), parts_(parts), sets_(columns.spans.size()) {
    join_pools();
    number_pools();
    find_ways();
  }

  void supply(std::uint32_t span, double volume) {
    if (!(volume > 0)) return;
    const PoolSet& pools = reach_[sets_.root(span)];
    const auto [known, is_new] = number_of_.try_emplace(pools, supply_.size());
    if (is_new) supply_.emplace_back(pools, 0);
    supply_[known->second].second += volume;
  }

  double most_that_stays() const {
    FreeFlow flow(room_.size() + supply_.size());
    for (std::uint32_t i = 0; i < room_.size(); ++i) flow.demand(i, room_[i]);
    auto from = static_cast<std::uint32_t>(room_.size());
    for (const auto& [pools, volume] : supply_) {
      flow.supply(from, volume);
      for (std::uint32_t i = 0; i < room_.size(); ++i) {
        if (pools[i]) flow.connect(from, i);
      }
      ++from;
    }
    return flow.most();
  }

 private:
  bool is_part(std::uint32_t span) const { return parts_[span].to > parts_[span].from; }

  template <typename F>
  void for_each_way(std::uint32_t span, const F& f) const {
    for (const AirPassage& passage : columns_.passages_of(span)) {
      const double sill = passage.sill_in(kUpsideDown);
      if (is_part(passage.to) && sill <= flood_.height[span]) f(passage.to, sill);
    }
  }

  // Spans between which liquid can run either way fill as one.
  void join_pools() {
    for (std::uint32_t i = 0; i < columns_.spans.size(); ++i) {
      if (!is_part(i)) continue;
      for_each_way(i, [&](std::uint32_t to, double sill) {
        if (sill <= flood_.height[to]) sets_.join(i, to);
      });
    }
  }

  void number_pools() {
    std::vector<double> room(columns_.spans.size(), 0);
    for (std::uint32_t i = 0; i < columns_.spans.size(); ++i) {
      if (is_part(i)) room[sets_.root(i)] += left_in(columns_, flood_, kUpsideDown, i, parts_[i]);
    }
    std::vector<std::uint32_t> pools;
    for (std::uint32_t i = 0; i < room.size(); ++i) {
      if (room[i] > 0) pools.push_back(i);
    }
    std::stable_sort(pools.begin(), pools.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return room[a] > room[b]; });
    reach_.resize(columns_.spans.size());
    room_.assign(std::min(pools.size(), kMostPools), 0);
    for (std::size_t i = 0; i < pools.size(); ++i) {
      const std::size_t number = std::min(i, kMostPools - 1);
      reach_[pools[i]].set(number);
      room_[number] += room[pools[i]];
    }
  }

  // What a span lets run into lies lower, and its own ways are known by then.
  void find_ways() {
    std::vector<std::uint32_t> rising;
    for (std::uint32_t i = 0; i < columns_.spans.size(); ++i) {
      if (is_part(i)) rising.push_back(i);
    }
    std::stable_sort(rising.begin(), rising.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return flood_.height[a] < flood_.height[b]; });
    for (const std::uint32_t i : rising) {
      PoolSet& own = reach_[sets_.root(i)];
      for_each_way(i, [&](std::uint32_t to, double) { own |= reach_[sets_.root(to)]; });
    }
  }

  const AirColumns& columns_;
  const AirFlood& flood_;
  const std::vector<AirPart>& parts_;
  DisjointSets sets_;
  std::vector<PoolSet> reach_;                          // by the root of a set
  std::vector<double> room_;                            // by pool
  std::vector<std::pair<PoolSet, double>> supply_;      // by where it can come to
  std::unordered_map<PoolSet, std::size_t> number_of_;  // of these
};

}  // namespace

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
  const double height =
      orientation == kUpright ? std::min(part.to, level) - part.from : part.to - std::max(part.from, -level);
  return columns.area() * std::max(0.0, height);
}

TrappedPools pools_in(const AirColumns& columns, const AirFloods& floods, const std::vector<AirPart>& parts) {
  TrappedPools pools;
  TurnedOver turned(columns, floods.upside_down, parts);
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (!(parts[i].to > parts[i].from)) continue;
    const double left = left_in(columns, floods.upright, kUpright, i, parts[i]);
    pools.total += columns.area() * (parts[i].to - parts[i].from);
    pools.upright += left;
    pools.upside_down += left_in(columns, floods.upside_down, kUpsideDown, i, parts[i]);
    turned.supply(i, left);
  }
  pools.after_both = std::min({pools.upright, pools.upside_down, turned.most_that_stays()});
  return pools;
}

}  // namespace aerate
