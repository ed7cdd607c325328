#include "packing/flood.h"

#include <algorithm>
#include <map>
#include <queue>
#include <tuple>

#include "kernels/constants.h"
#include "packing/pools.h"

namespace aerate {
namespace {

// The lowest first, then the shortest; the rest makes the order one of its own.
struct ComesAfter {
  bool operator()(const FloodStep& a, const FloodStep& b) const {
    return std::tie(a.height, a.length, a.to, a.from, a.way) >
           std::tie(b.height, b.length, b.to, b.from, b.way);
  }
};

class Flood {
 public:
  Flood(const DrainageTask& task, const Draft& draft, Vec3d up)
      : task_(task), draft_(draft), up_(up), channels_of_(task.voids.size()) {
    for (const Channel& channel : draft.tubes.plan().channels) {
      const double sill = sill_of(channel.tube, task.voids[channel.from], task.voids[channel.to], up);
      channels_of_[channel.from].push_back({channel.to, sill});
      channels_of_[channel.to].push_back({channel.from, sill});
    }
  }

  std::vector<FloodStep> run(const std::function<bool(std::size_t)>& make) {
    push_lowest_holes();
    std::vector<FloodStep> steps(task_.voids.size(), {kInfinity, 0, kNone, kNone, kExistingChannel});
    while (!queue_.empty()) {
      const FloodStep next = queue_.top();
      queue_.pop();
      if (steps[next.to].to != kNone) continue;
      if (next.way != kExistingChannel && !make(next.way)) continue;
      steps[next.to] = next;
      push_ways(next.to, next.height);
    }
    return steps;
  }

 private:
  struct ExistingChannel {
    std::uint32_t to;
    double sill;
  };

  void push_lowest_holes() {
    std::map<std::uint32_t, const EscapeHole*> lowest_of;
    for (const EscapeHole& hole : draft_.tubes.plan().holes) {
      const EscapeHole*& lowest = lowest_of[draft_.network_of[hole.from]];
      if (lowest == nullptr || dot(hole.tube.end, up_) < dot(lowest->tube.end, up_)) lowest = &hole;
    }
    for (const auto& [network, hole] : lowest_of)
      queue_.push(
          {sill_of_hole(*hole, task_.voids[hole->from], up_), 0, hole->from, kNone, kExistingChannel});
  }

  void push_ways(std::uint32_t from, double height) {
    for (const auto& [to, sill] : channels_of_[from])
      queue_.push({std::max(height, sill), 0, to, from, kExistingChannel});
    const std::size_t orientation = dot(up_, task_.up()) > 0 ? 0 : 1;
    for (const std::uint32_t index : task_.ways.of(from)) {
      const ChannelWay& way = task_.ways[index];
      const std::uint32_t to = way.other_than(from);
      if (draft_.network_of[to] != draft_.network_of[from]) continue;
      const Tube& tube = way.channel.tube;
      queue_.push({std::max(height, way.sills[orientation]), length(tube.end - tube.start), to, from, index});
    }
  }

  const DrainageTask& task_;
  const Draft& draft_;
  Vec3d up_;
  std::vector<std::vector<ExistingChannel>> channels_of_;  // before the flood
  std::priority_queue<FloodStep, std::vector<FloodStep>, ComesAfter> queue_;
};

}  // namespace

std::vector<FloodStep> flood(const DrainageTask& task, const Draft& draft, Vec3d up,
                             const std::function<bool(std::size_t)>& make) {
  return Flood(task, draft, up).run(make);
}

}  // namespace aerate
