#include "packing/cells/cell_drainage_hollows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/disjoint_sets.h"
#include "kernels/constants.h"

namespace aerate {
namespace {

// Of a hollow's lowest nodes those are remembered that are less than this above the lowest.
constexpr std::int32_t kFloorLevels = kLevelsPerSpacing + kLevelsPerSpacing / 4;

// Runs of one row: y and z are the same.
struct Row {
  std::int32_t y, z;
  std::size_t begin, end;
};

std::vector<Row> rows_of(const VoidNodes& nodes) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < nodes.runs.size(); ++i) {
    const NodeRun& run = nodes.runs[i];
    if (rows.empty() || rows.back().y != run.y || rows.back().z != run.z)
      rows.push_back({run.y, run.z, i, i});
    rows.back().end = i + 1;
  }
  return rows;
}

void link(const VoidNodes& nodes, const Row& before, const Row& after, std::vector<std::uint32_t>& backwards,
          std::vector<std::uint32_t>& forwards) {
  std::size_t i = before.begin, j = after.begin;
  while (i < before.end && j < after.end) {
    const NodeRun &a = nodes.runs[i], &b = nodes.runs[j];
    for (std::int32_t x = std::max(a.first, b.first); x <= std::min(a.last, b.last); ++x) {
      const std::uint32_t in_a = nodes.first[i] + static_cast<std::uint32_t>(x - a.first);
      const std::uint32_t in_b = nodes.first[j] + static_cast<std::uint32_t>(x - b.first);
      forwards[in_a] = in_b;
      backwards[in_b] = in_a;
    }
    a.last < b.last ? ++i : ++j;
  }
}

// Hollows while nodes are added in order of height.
class Growth {
 public:
  Growth(std::size_t nodes, std::vector<std::uint32_t>& of_node)
      : of_node_(of_node), sets_(nodes), hollow_of_set_(nodes, kNone) {
    of_node_.assign(nodes, kNone);
  }

  void add(std::uint32_t node, std::int32_t level, std::span<const std::uint32_t> neighbours) {
    std::array<std::uint32_t, 6> around{};
    std::size_t count = 0;
    for (const std::uint32_t neighbour : neighbours) {
      if (neighbour == kNone || of_node_[neighbour] == kNone) continue;
      const std::uint32_t hollow = hollow_of_set_[sets_.root(neighbour)];
      if (std::find(around.begin(), around.begin() + count, hollow) == around.begin() + count)
        around[count++] = hollow;
    }
    const std::uint32_t hollow = count == 0 ? begin(level) : merged({around.data(), count}, level);
    of_node_[node] = hollow;
    if (level - bottom_[hollow] < kFloorLevels) floor_[hollow].push_back(node);
    for (const std::uint32_t neighbour : neighbours) {
      if (neighbour != kNone && of_node_[neighbour] != kNone) sets_.join(node, neighbour);
    }
    hollow_of_set_[sets_.root(node)] = hollow;
  }

  // Pieces that do not hang together by six neighbours are taken for one above all of them.
  void finish(std::int32_t highest) {
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) {
      if (parent_[i] == kNone && same_as_[i] == i) open.push_back(i);
    }
    if (open.size() > 1) join(open, highest);
  }

  // With those numbers left out that turned out to be the same as others.
  HollowForest forest() {
    HollowForest forest;
    std::vector<std::uint32_t> number(parent_.size(), kNone);
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) {
      if (same_as_[i] == i) number[i] = count++;
    }
    for (std::uint32_t i = 0; i < parent_.size(); ++i) {
      if (same_as_[i] != i) continue;
      forest.parent.push_back(parent_[i] == kNone ? kNone : number[final_of(parent_[i])]);
      forest.rim.push_back(rim_[i]);
      forest.bottom.push_back(bottom_[i]);
      forest.floor.push_back(std::move(floor_[i]));
    }
    forest.of_node = std::move(of_node_);
    for (std::uint32_t& hollow : forest.of_node) hollow = number[final_of(hollow)];
    return forest;
  }

 private:
  std::uint32_t begin(std::int32_t level) {
    const auto number = static_cast<std::uint32_t>(parent_.size());
    parent_.push_back(kNone);
    same_as_.push_back(number);
    rim_.push_back(0);
    bottom_.push_back(level);
    floor_.emplace_back();
    return number;
  }

  // What several hollows are from here on; those that are not deep become part of the deepest.
  std::uint32_t merged(std::span<std::uint32_t> hollows, std::int32_t level) {
    const auto deepest =
        std::min_element(hollows.begin(), hollows.end(), [&](std::uint32_t a, std::uint32_t b) {
          return bottom_[a] != bottom_[b] ? bottom_[a] < bottom_[b] : a < b;
        });
    std::swap(hollows.front(), *deepest);
    std::vector<std::uint32_t> deep{hollows.front()};
    for (const std::uint32_t hollow : hollows.subspan(1)) {
      if (level - bottom_[hollow] >= kLevelsPerSpacing)
        deep.push_back(hollow);
      else
        same_as_[hollow] = hollows.front();
    }
    return deep.size() == 1 ? deep.front() : join(deep, level);
  }

  std::uint32_t join(std::span<const std::uint32_t> hollows, std::int32_t level) {
    const std::uint32_t above = begin(level);
    for (const std::uint32_t hollow : hollows) {
      parent_[hollow] = above;
      rim_[hollow] = level;
      bottom_[above] = std::min(bottom_[above], bottom_[hollow]);
    }
    return above;
  }

  std::uint32_t final_of(std::uint32_t hollow) {
    while (same_as_[hollow] != hollow) hollow = same_as_[hollow] = same_as_[same_as_[hollow]];
    return hollow;
  }

  std::vector<std::uint32_t>& of_node_;
  DisjointSets sets_;
  std::vector<std::uint32_t> hollow_of_set_;  // by its root
  std::vector<std::uint32_t> parent_, same_as_;
  std::vector<std::int32_t> rim_, bottom_;
  std::vector<std::vector<std::uint32_t>> floor_;
};

}  // namespace

NodeLevels::NodeLevels(const VoidNodes& nodes, Vec3d up) {
  levels_.reserve(nodes.size());
  for (const NodeRun& run : nodes.runs) {
    for (std::int32_t x = run.first; x <= run.last; ++x) {
      const double height = up.x * x + up.y * run.y + up.z * run.z;
      levels_.push_back(static_cast<std::int32_t>(std::lround(height * kLevelsPerSpacing)));
    }
  }
  if (levels_.empty()) return;
  const auto [least, most] = std::minmax_element(levels_.begin(), levels_.end());
  const std::int32_t lowest = *least;
  std::vector<std::uint32_t> place(static_cast<std::size_t>(*most - lowest) + 2, 0);
  for (const std::int32_t level : levels_) ++place[static_cast<std::size_t>(level - lowest) + 1];
  std::partial_sum(place.begin(), place.end(), place.begin());
  ascending_.resize(levels_.size());
  for (std::uint32_t i = 0; i < levels_.size(); ++i)
    ascending_[place[static_cast<std::size_t>(levels_[i] - lowest)]++] = i;
}

NodeLinks::NodeLinks(const VoidNodes& nodes)
    : before_y(nodes.size(), kNone),
      after_y(nodes.size(), kNone),
      before_z(nodes.size(), kNone),
      after_z(nodes.size(), kNone),
      begins(nodes.size() + 1, false) {
  for (const std::uint32_t first : nodes.first) begins[first] = true;
  const std::vector<Row> rows = rows_of(nodes);
  std::size_t below = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    if (i > 0 && rows[i - 1].z == row.z && rows[i - 1].y == row.y - 1)
      link(nodes, rows[i - 1], row, before_y, after_y);
    while (rows[below].z < row.z - 1 || (rows[below].z == row.z - 1 && rows[below].y < row.y)) ++below;
    if (rows[below].z == row.z - 1 && rows[below].y == row.y)
      link(nodes, rows[below], row, before_z, after_z);
  }
}

HollowForest grow_hollows(const VoidNodes& nodes, const NodeLinks& links, const NodeLevels& levels,
                          std::size_t orientation) {
  std::vector<std::uint32_t> of_node;
  Growth growth(nodes.size(), of_node);
  const std::span<const std::uint32_t> ascending = levels.ascending();
  const std::int32_t sign = orientation == kUpright ? 1 : -1;
  for (std::size_t i = 0; i < ascending.size(); ++i) {
    const std::uint32_t node = ascending[orientation == kUpright ? i : ascending.size() - 1 - i];
    const std::array<std::uint32_t, 6> around{links.begins[node] ? kNone : node - 1,
                                              links.begins[node + 1] ? kNone : node + 1,
                                              links.before_y[node],
                                              links.after_y[node],
                                              links.before_z[node],
                                              links.after_z[node]};
    growth.add(node, sign * levels.of(node), around);
  }
  if (!ascending.empty()) {
    const std::uint32_t highest = orientation == kUpright ? ascending.back() : ascending.front();
    growth.finish(sign * levels.of(highest));
  }
  return growth.forest();
}

}  // namespace aerate
