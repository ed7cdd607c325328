#include "packing/cells/cell_drainage_pools.h"

#include <algorithm>
#include <map>
#include <queue>
#include <tuple>
#include <utility>

#include "kernels/constants.h"
#include "packing/cells/cell_drainage_flow.h"

namespace aerate {
namespace {

// Vertices with what else they are joined to: passages beside each hollow.
struct Beside {
  std::vector<std::uint32_t> first, passages;

  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return std::span(passages).subspan(first[vertex], first[vertex + 1] - first[vertex]);
  }
};

template <typename F>
void for_each_mouth(const CellPools& pools, const Passage& passage, std::size_t orientation, const F& f) {
  for (const Mouth& mouth : passage.mouths) {
    if (mouth.into == kNone) continue;
    for (const std::uint32_t hollow : mouth.hollows[orientation])
      f(pools.vertex(mouth.into, hollow, orientation));
  }
}

Beside beside(const CellPools& pools, const Passages& passages, std::size_t orientation) {
  Beside result;
  result.first.assign(pools.hollow_count(orientation) + 1, 0);
  for (const Passage* passage : passages)
    for_each_mouth(pools, *passage, orientation, [&](std::uint32_t v) { ++result.first[v + 1]; });
  for (std::size_t i = 1; i < result.first.size(); ++i) result.first[i] += result.first[i - 1];
  result.passages.resize(result.first.back());
  std::vector<std::uint32_t> next = result.first;
  for (std::uint32_t i = 0; i < passages.size(); ++i)
    for_each_mouth(pools, *passages[i], orientation,
                   [&](std::uint32_t v) { result.passages[next[v]++] = i; });
  return result;
}

}  // namespace

CellPools::CellPools(std::span<const VoidHollows> voids) : voids_(voids) {
  for (const std::size_t orientation : {kUpright, kUpsideDown}) {
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < voids.size(); ++i) {
      first_[orientation].push_back(count);
      count += static_cast<std::uint32_t>(voids[i].in(orientation).size());
      void_of_[orientation].resize(count, i);
    }
    first_[orientation].push_back(count);
  }
}

HollowFlood CellPools::flood(const Passages& passages, std::size_t orientation, const Accept& accept) const {
  const std::uint32_t hollows = hollow_count(orientation);
  const std::size_t count = hollows + passages.size();
  HollowFlood result{std::vector<double>(count, kInfinity), std::vector<std::uint32_t>(count, kNone)};
  const Beside joined = beside(*this, passages, orientation);
  // Height, the passage's own sill (hollows first), vertex, towards.
  using Step = std::tuple<double, double, std::uint32_t, std::uint32_t>;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
  for (std::uint32_t i = 0; i < passages.size(); ++i) {
    const double sill = passages[i]->sill[orientation];
    if (passages[i]->leads_out()) open.push({sill, sill, hollows + i, kNone});
  }
  std::vector<bool> is_done(count, false), is_reached(voids_.size(), false);
  while (!open.empty()) {
    const auto [height, own, at, towards] = open.top();
    open.pop();
    if (is_done[at]) continue;
    is_done[at] = true;
    if (at >= hollows) {
      const Passage& passage = *passages[at - hollows];
      if (!passage.leads_out() && accept) {
        const bool reaches = !is_reached[passage.mouths[0].into] || !is_reached[passage.mouths[1].into];
        if (!accept(at - hollows, reaches)) continue;
      }
      for (const Mouth& mouth : passage.mouths) {
        if (mouth.into != kNone) is_reached[mouth.into] = true;
      }
      for_each_mouth(*this, passage, orientation, [&, from = at, level = height](std::uint32_t v) {
        if (!is_done[v]) open.push({level, -kInfinity, v, from});
      });
    } else {
      const std::uint32_t in = void_of_[orientation][at], first = first_[orientation][in];
      const Hollows& own_hollows = voids_[in].in(orientation);
      const std::uint32_t hollow = at - first;
      const auto go = [&, from = at, level = height](std::uint32_t next, double rim) {
        if (!is_done[first + next]) open.push({std::max(level, rim), -kInfinity, first + next, from});
      };
      if (own_hollows.parent[hollow] != kNone) go(own_hollows.parent[hollow], own_hollows.rim[hollow]);
      for (const std::uint32_t child : own_hollows.children[hollow]) go(child, own_hollows.rim[child]);
      for (const std::uint32_t i : joined.of(at)) {
        const double sill = passages[i]->sill[orientation];
        if (!is_done[hollows + i]) open.push({std::max(height, sill), sill, hollows + i, at});
      }
    }
    result.height[at] = height;
    result.towards[at] = towards;
  }
  return result;
}

std::vector<double> CellPools::stays_in(const HollowFlood& flood, std::size_t orientation) const {
  std::vector<double> stays(voids_.size(), 0);
  for (std::uint32_t i = 0; i < voids_.size(); ++i) {
    for (const VoidHollows::Piece& piece : voids_[i].pieces()) {
      const std::uint32_t hollow = orientation == kUpright ? piece.upright : piece.upside_down;
      stays[i] += piece_below(piece, orientation, flood.height[vertex(i, hollow, orientation)]);
    }
  }
  return stays;
}

TrappedPools CellPools::measure(const Passages& passages, std::span<const char> is_kept) const {
  const HollowFlood upright = flood(passages, kUpright), turned = flood(passages, kUpsideDown);
  const std::uint32_t hollows = hollow_count(kUpsideDown);
  TrappedPools pools;
  FreeFlow flow(turned.height.size());
  for (std::uint32_t i = 0; i < voids_.size(); ++i) {
    if (is_kept[i] == 0) continue;
    pools.total += voids_[i].volume();
    for (const VoidHollows::Piece& piece : voids_[i].pieces()) {
      const std::uint32_t down = vertex(i, piece.upside_down, kUpsideDown);
      const double left = piece_below(piece, kUpright, upright.height[vertex(i, piece.upright, kUpright)]);
      const double room = piece_below(piece, kUpsideDown, turned.height[down]);
      pools.upright += left;
      pools.upside_down += room;
      flow.supply(down, left);
      flow.demand(down, room);
    }
    const Hollows& own = voids_[i].in(kUpsideDown);
    for (std::uint32_t hollow = 0; hollow < own.size(); ++hollow) {
      if (own.parent[hollow] != kNone)
        flow.connect(vertex(i, own.parent[hollow], kUpsideDown), vertex(i, hollow, kUpsideDown));
    }
  }
  for (std::uint32_t v = 0; v < turned.height.size(); ++v) {
    if (turned.towards[v] != kNone) flow.connect(v, turned.towards[v]);
    // What runs over a sill falls into the hollow beyond, whichever of those beside the passage it is.
    if (v < hollows || turned.towards[v] == kNone) continue;
    const std::uint32_t from = turned.towards[v];
    for_each_mouth(*this, *passages[v - hollows], kUpsideDown, [&](std::uint32_t beside) {
      if (void_of_[kUpsideDown][beside] == void_of_[kUpsideDown][from]) flow.connect(v, beside);
    });
  }
  pools.after_both = std::min({pools.upright, pools.upside_down, flow.most()});
  return pools;
}

std::vector<Basin> CellPools::basins(const HollowFlood& flood, std::size_t orientation,
                                     std::span<const char> is_kept) const {
  const auto root_of = [&](std::uint32_t at) {
    while (flood.height[at] < kInfinity) {
      const std::uint32_t next = flood.towards[at];
      if (next == kNone || flood.height[next] != flood.height[at]) break;
      at = next;
    }
    return at;
  };
  std::map<std::uint32_t, Basin> basin_of;
  for (std::uint32_t i = 0; i < voids_.size(); ++i) {
    if (is_kept[i] == 0) continue;
    for (const VoidHollows::Piece& piece : voids_[i].pieces()) {
      const std::uint32_t hollow = orientation == kUpright ? piece.upright : piece.upside_down;
      const std::uint32_t at = vertex(i, hollow, orientation);
      const double volume = piece_below(piece, orientation, flood.height[at]);
      if (volume <= 0) continue;
      Basin& basin = basin_of[root_of(at)];
      basin.volume += volume;
      basin.hollows.push_back({i, hollow});
    }
  }
  std::vector<Basin> basins;
  for (auto& [root, basin] : basin_of) {
    const auto before = [](const Basin::Part& a, const Basin::Part& b) {
      return std::tie(a.in, a.hollow) < std::tie(b.in, b.hollow);
    };
    std::sort(basin.hollows.begin(), basin.hollows.end(), before);
    const auto same = [](const Basin::Part& a, const Basin::Part& b) {
      return a.in == b.in && a.hollow == b.hollow;
    };
    basin.hollows.erase(std::unique(basin.hollows.begin(), basin.hollows.end(), same), basin.hollows.end());
    basins.push_back(std::move(basin));
  }
  std::stable_sort(basins.begin(), basins.end(),
                   [](const Basin& a, const Basin& b) { return a.volume > b.volume; });
  return basins;
}

}  // namespace aerate
