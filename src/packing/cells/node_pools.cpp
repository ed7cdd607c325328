#include "packing/cells/node_pools.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "kernels/constants.h"
#include "packing/cells/cell_drainage_hollows.h"
#include "packing/cells/node_spans.h"

namespace aerate {
namespace {

// So many of the lowest nodes of a hollow are remembered at most.
constexpr std::size_t kMostFloorNodes = 16;

// Runs of one row that touch or overlap become one.
std::vector<NodeRun> united(std::vector<NodeRun> runs) {
  std::sort(runs.begin(), runs.end(), [](const NodeRun& a, const NodeRun& b) {
    return std::tie(a.z, a.y, a.first, a.last) < std::tie(b.z, b.y, b.first, b.last);
  });
  std::vector<NodeRun> rows;
  for (const NodeRun& run : runs) {
    const bool joins = !rows.empty() && rows.back().z == run.z && rows.back().y == run.y &&
                       run.first <= rows.back().last + 1;
    if (joins)
      rows.back().last = std::max(rows.back().last, run.last);
    else
      rows.push_back(run);
  }
  return rows;
}

void number(VoidNodes& nodes) {
  nodes.first.assign(1, 0);
  for (const NodeRun& run : nodes.runs)
    nodes.first.push_back(nodes.first.back() + static_cast<std::uint32_t>(run.last - run.first + 1));
}

// Thinned evenly.
void thin(std::vector<std::uint32_t>& nodes) {
  if (nodes.size() <= kMostFloorNodes) return;
  std::sort(nodes.begin(), nodes.end());
  std::vector<std::uint32_t> few;
  for (std::size_t i = 0; i < kMostFloorNodes; ++i)
    few.push_back(nodes[(2 * i + 1) * nodes.size() / (2 * kMostFloorNodes)]);
  nodes = std::move(few);
}

Hollows hollows_of(HollowForest forest, double base, double spacing) {
  const double step = spacing / kLevelsPerSpacing;
  Hollows hollows;
  const std::size_t count = forest.parent.size();
  hollows.parent = std::move(forest.parent);
  hollows.of_node = std::move(forest.of_node);
  hollows.floor = std::move(forest.floor);
  hollows.children.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t parent = hollows.parent[i];
    // Where two hollows meet, the floor is half a spacing below the first node that both reach.
    const double meet = base + step * static_cast<double>(forest.rim[i]) - spacing / 2;
    hollows.rim.push_back(parent == kNone ? kInfinity : meet);
    hollows.bottom.push_back(base + step * static_cast<double>(forest.bottom[i]));
    if (parent != kNone) hollows.children[parent].push_back(static_cast<std::uint32_t>(i));
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!hollows.children[i].empty()) hollows.floor[i].clear();
    thin(hollows.floor[i]);
  }
  return hollows;
}

// The volume of nodes by height, in levels, while they are added from the lowest up.
class LayeredVolume {
 public:
  explicit LayeredVolume(std::int32_t lowest) : first_(lowest - kLevelsPerSpacing) {}

  // A node at a level stands for so many levels below and above it: a spacing at most.
  void add(std::int32_t level, double below, double above, double weight) {
    const auto begin = static_cast<std::size_t>(level - first_ - std::lround(below));
    const std::size_t end =
        std::max(begin + 1, static_cast<std::size_t>(level - first_ + std::lround(above)));
    if (end >= steeper_.size()) steeper_.resize(end + 1, 0);
    const double held = weight * static_cast<double>(end - begin);
    steeper_[begin] += weight;
    steeper_[end] -= weight;
    sum_ += held;
  }

  double sum() const { return sum_; }

  // Gives a piece its heights and volumes; `unit`: mm3 for each of sum().
  void spread(VoidHollows::Piece& piece, double base, double step, double unit) const {
    double slope = 0, below = 0;
    for (std::size_t i = 0; i < steeper_.size(); ++i) {
      if (steeper_[i] != 0) {
        piece.heights.push_back(base + step * static_cast<double>(first_ + static_cast<std::int64_t>(i)));
        piece.volumes.push_back(unit * below);
        slope += steeper_[i];
      }
      below += slope;
    }
  }

 private:
  std::int32_t first_;
  std::vector<double> steeper_;  // by level: how much more there is in each level from here on
  double sum_ = 0;
};

}  // namespace

Vec3d VoidNodes::at(std::uint32_t node) const {
  const auto run =
      static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), node) - first.begin()) - 1;
  const auto along = static_cast<std::int32_t>(node - first[run]);
  return lattice.at(runs[run].first + along, runs[run].y, runs[run].z);
}

std::uint32_t VoidNodes::number_of(std::int32_t x, std::int32_t y, std::int32_t z) const {
  // The last run that begins at or before the node.
  const auto after = std::upper_bound(
      runs.begin(), runs.end(), std::tuple(z, y, x),
      [](const auto& key, const NodeRun& run) { return key < std::tuple(run.z, run.y, run.first); });
  if (after == runs.begin()) return kNone;
  const NodeRun& run = *(after - 1);
  if (run.z != z || run.y != y || x > run.last) return kNone;
  return first[static_cast<std::size_t>(after - 1 - runs.begin())] +
         static_cast<std::uint32_t>(x - run.first);
}

VoidNodes nodes_of(const CellVoid& cell_void, const NodeLattice& lattice, int halvings) {
  VoidNodes nodes{.lattice = lattice, .runs = cell_void.nodes, .first = {}, .weights = {}};
  if (halvings > 0) {
    const double half = 0.5 * ((1 << halvings) - 1) * lattice.spacing;  // a block counts at its middle
    nodes.lattice.origin = lattice.origin + Vec3d{half, half, half};
    nodes.lattice.spacing = lattice.spacing * (1 << halvings);
    for (NodeRun& run : nodes.runs)
      run = {run.first >> halvings, run.last >> halvings, run.y >> halvings, run.z >> halvings};
    nodes.runs = united(std::move(nodes.runs));
  }
  number(nodes);
  if (halvings == 0) return nodes;
  nodes.weights.assign(nodes.size(), 0);
  for (const NodeRun& run : cell_void.nodes) {
    for (std::int32_t x = run.first; x <= run.last; ++x) {
      ++nodes.weights[nodes.number_of(x >> halvings, run.y >> halvings, run.z >> halvings)];
    }
  }
  return nodes;
}

VoidHollows::VoidHollows(VoidNodes nodes, Vec3d up, double volume, const Mesh& surface)
    : nodes_(std::move(nodes)), up_(up), volume_(volume) {
  const NodeLevels levels(nodes_, up);
  const double step = nodes_.lattice.spacing / kLevelsPerSpacing;
  const double base = dot(up, nodes_.lattice.origin);
  const NodeLinks links(nodes_);
  HollowForest upright = grow_hollows(nodes_, links, levels, kUpright);
  HollowForest turned = grow_hollows(nodes_, links, levels, kUpsideDown);

  std::vector<LayeredVolume> layered;
  std::vector<std::vector<std::uint32_t>> pieces_of(upright.parent.size());
  const NodeSpans spans = spans_of(nodes_, surface, up);
  for (const std::uint32_t node : levels.ascending()) {
    const std::uint32_t a = upright.of_node[node], b = turned.of_node[node];
    std::vector<std::uint32_t>& own = pieces_of[a];
    const auto found =
        std::find_if(own.begin(), own.end(), [&](std::uint32_t i) { return pieces_[i].upside_down == b; });
    const auto number = found == own.end() ? static_cast<std::uint32_t>(pieces_.size()) : *found;
    if (number == pieces_.size()) {
      own.push_back(number);
      pieces_.push_back({a, b, {}, {}});
      layered.emplace_back(levels.of(node));
    }
    const double below = spans.below[node], above = spans.above[node];
    layered[number].add(levels.of(node), below / step, above / step,
                        nodes_.weights.empty() ? 1 : nodes_.weights[node]);
  }
  double sum = 0;
  for (const LayeredVolume& own : layered) sum += own.sum();
  for (std::size_t i = 0; i < pieces_.size(); ++i)
    layered[i].spread(pieces_[i], base, step, sum > 0 ? volume / sum : 0);
  hollows_[kUpright] = hollows_of(std::move(upright), base, nodes_.lattice.spacing);
  hollows_[kUpsideDown] = hollows_of(std::move(turned), -base, nodes_.lattice.spacing);
}

double VoidHollows::height_of(std::uint32_t node, std::size_t orientation) const {
  const double height = dot(nodes_.at(node), up_);
  return orientation == kUpright ? height : -height;
}

std::vector<std::uint32_t> VoidHollows::nodes_near(const Segment& segment, double radius) const {
  const Vec3d reach{radius, radius, radius};
  const NodeLattice& lattice = nodes_.lattice;
  const Vec3d lower = (min_of(segment.start, segment.end) - reach - lattice.origin) * (1 / lattice.spacing);
  const Vec3d upper = (max_of(segment.start, segment.end) + reach - lattice.origin) * (1 / lattice.spacing);
  const auto up = [](double x) { return static_cast<std::int32_t>(std::ceil(x)); };
  const auto down = [](double x) { return static_cast<std::int32_t>(std::floor(x)); };
  std::vector<std::uint32_t> near;
  for (std::int32_t z = up(lower.z); z <= down(upper.z); ++z) {
    for (std::int32_t y = up(lower.y); y <= down(upper.y); ++y) {
      for (std::int32_t x = up(lower.x); x <= down(upper.x); ++x) {
        if (distance_to_point(segment, lattice.at(x, y, z)) > radius) continue;
        const std::uint32_t node = nodes_.number_of(x, y, z);
        if (node != kNone) near.push_back(node);
      }
    }
  }
  return near;
}

std::vector<std::uint32_t> VoidHollows::hollows_near(const Segment& segment, double radius, double sill,
                                                     std::size_t orientation) const {
  if (nodes_.size() == 0) return {};
  std::vector<std::uint32_t> near = nodes_near(segment, radius);
  constexpr int kMostWidenings = 6;
  for (int i = 1; near.empty() && i <= kMostWidenings; ++i)
    near = nodes_near(segment, radius + i * nodes_.lattice.spacing);
  if (near.empty()) near.push_back(0);
  double lowest = kInfinity;
  for (const std::uint32_t node : near) lowest = std::min(lowest, height_of(node, orientation));
  const double highest = std::max(lowest, sill + nodes_.lattice.spacing) + 1e-9;
  std::vector<std::uint32_t> hollows;
  for (const std::uint32_t node : near) {
    if (height_of(node, orientation) <= highest) hollows.push_back(hollows_[orientation].of_node[node]);
  }
  std::sort(hollows.begin(), hollows.end());
  hollows.erase(std::unique(hollows.begin(), hollows.end()), hollows.end());
  return hollows;
}

double piece_below(const VoidHollows::Piece& piece, std::size_t orientation, double height) {
  if (height == kInfinity) return piece.volume();
  if (height == -kInfinity) return 0;
  if (orientation == kUpsideDown) return piece.volume() - piece_below(piece, kUpright, -height);
  const auto above = std::upper_bound(piece.heights.begin(), piece.heights.end(), height);
  if (above == piece.heights.begin()) return 0;
  if (above == piece.heights.end()) return piece.volume();
  const auto i = static_cast<std::size_t>(above - piece.heights.begin());
  const double share = (height - piece.heights[i - 1]) / (piece.heights[i] - piece.heights[i - 1]);
  return piece.volumes[i - 1] + share * (piece.volumes[i] - piece.volumes[i - 1]);
}

}  // namespace aerate
