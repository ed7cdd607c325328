#include "packing/cells/cell_drainage_flow.h"

#include <algorithm>
#include <limits>

#include "kernels/constants.h"

namespace aerate {
namespace {

constexpr double kUnlimited = 1e30;
constexpr double kLeast = 1e-9;  // mm3

}  // namespace

FreeFlow::FreeFlow(std::size_t count)
    : source_(static_cast<std::uint32_t>(count)),
      sink_(static_cast<std::uint32_t>(count + 1)),
      leave_(count + 2) {}

void FreeFlow::add(std::uint32_t from, std::uint32_t to, double room) {
  leave_[from].push_back(static_cast<std::uint32_t>(edges_.size()));
  edges_.push_back({to, room});
  leave_[to].push_back(static_cast<std::uint32_t>(edges_.size()));
  edges_.push_back({from, 0});
}

void FreeFlow::supply(std::uint32_t vertex, double amount) {
  if (amount > kLeast) add(source_, vertex, amount);
}

void FreeFlow::demand(std::uint32_t vertex, double amount) {
  if (amount > kLeast) add(vertex, sink_, amount);
}

void FreeFlow::connect(std::uint32_t from, std::uint32_t to) {
  add(from, to, kUnlimited);
}

bool FreeFlow::level() {
  level_.assign(leave_.size(), kNone);
  std::vector<std::uint32_t> queue{source_};
  level_[source_] = 0;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    for (const std::uint32_t e : leave_[queue[i]]) {
      const Edge& edge = edges_[e];
      if (edge.room <= kLeast || level_[edge.to] != kNone) continue;
      level_[edge.to] = level_[queue[i]] + 1;
      queue.push_back(edge.to);
    }
  }
  return level_[sink_] != kNone;
}

// One way from the source to the sink, over vertices of ascending level.
double FreeFlow::push() {
  std::vector<std::uint32_t> way;
  std::uint32_t at = source_;
  while (at != sink_) {
    bool goes_on = false;
    for (; next_[at] < leave_[at].size(); ++next_[at]) {
      const Edge& edge = edges_[leave_[at][next_[at]]];
      if (edge.room <= kLeast || level_[edge.to] != level_[at] + 1) continue;
      way.push_back(leave_[at][next_[at]]);
      at = edge.to;
      goes_on = true;
      break;
    }
    if (goes_on) continue;
    if (way.empty()) return 0;
    at = edges_[way.back() ^ 1].to;
    way.pop_back();
    ++next_[at];
  }
  double amount = std::numeric_limits<double>::infinity();
  for (const std::uint32_t e : way) amount = std::min(amount, edges_[e].room);
  for (const std::uint32_t e : way) {
    edges_[e].room -= amount;
    edges_[e ^ 1].room += amount;
  }
  return amount;
}

double FreeFlow::most() {
  double flow = 0;
  while (level()) {
    next_.assign(leave_.size(), 0);
    while (true) {
      const double amount = push();
      if (!(amount > 0)) break;
      flow += amount;
    }
  }
  return flow;
}

}  // namespace aerate
