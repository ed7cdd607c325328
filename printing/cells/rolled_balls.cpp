#include "printing/cells/rolled_balls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/disjoint_sets.h"
#include "printing/cells/nearest_in_halfspaces.h"

namespace aerate {
namespace {

constexpr float kUncovered = -1e9F;

// A node counts as covered if it is so deep in a ball, in spacings.
constexpr float kLeastCover = 1e-3F;

// Nodes of one line along an axis within a distance of a coordinate. `cut`: nodes from the origin to its first one.
struct NodeRange {
  std::int32_t first, last;

  NodeRange(double middle, double reach, double origin, double spacing, std::int32_t cut, std::int32_t count)
      : first(std::max(0, static_cast<std::int32_t>(std::ceil((middle - reach - origin) / spacing)) - cut)),
        last(std::min(count - 1,
                      static_cast<std::int32_t>(std::floor((middle + reach - origin) / spacing)) - cut)) {}
};

double square(double x) {
  return x * x;
}

class Roller {
 public:
  Roller(const CellRegion& region, const CellNodes& nodes, OpenedCell& opened)
      : region_(region), nodes_(nodes), opened_(opened) {}

  void roll(const Sphere& own, SharedWork& work) {
    const NodeBox& box = nodes_.box;
    const auto layers = static_cast<std::size_t>(box.count_z);
    std::vector<std::vector<RolledBall>> of_layer(layers);
    work.for_each(layers, 1, [&](std::size_t k) { of_layer[k] = balls_of(static_cast<std::int32_t>(k)); });
    std::vector<BallsOfLayer> groups;
    for (std::size_t k = 0; k < layers; ++k) add(of_layer[k], groups);
    if (has_room_for(own)) add({{own.centre, own.radius, kNone, true}}, groups);
    constexpr std::size_t kGrain = 8;
    work.for_each_part(layers, kGrain, [&](std::size_t first, std::size_t last) {
      const auto first_layer = static_cast<std::int32_t>(first),
                 last_layer = static_cast<std::int32_t>(last) - 1;
      for (const BallsOfLayer& group : groups) {
        if (!may_reach(group, first_layer, last_layer)) continue;
        for (std::uint32_t ball = group.first; ball < group.last; ++ball)
          cover(ball, first_layer, last_layer);
      }
    });
  }

 private:
  // Balls in the order in which they were found, and how low and high they reach.
  struct BallsOfLayer {
    std::uint32_t first = 0, last = 0;
    double lowest = kInfinity, highest = -kInfinity;
  };

  void add(const std::vector<RolledBall>& balls, std::vector<BallsOfLayer>& groups) {
    if (balls.empty()) return;
    BallsOfLayer group{.first = static_cast<std::uint32_t>(opened_.balls.size())};
    opened_.balls.insert(opened_.balls.end(), balls.begin(), balls.end());
    group.last = static_cast<std::uint32_t>(opened_.balls.size());
    for (const RolledBall& ball : balls) {
      group.lowest = std::min(group.lowest, ball.centre.z - reach_of(ball));
      group.highest = std::max(group.highest, ball.centre.z + reach_of(ball));
    }
    groups.push_back(group);
  }

  // Nodes just outside tell where the surface passes.
  double reach_of(const RolledBall& ball) const { return ball.radius + 1.2 * nodes_.box.lattice.spacing; }

  double height_of_layer(std::int32_t k) const {
    return nodes_.box.origin().z + nodes_.box.lattice.spacing * (k + nodes_.box.cut_z);
  }

  bool may_reach(const BallsOfLayer& group, std::int32_t first_layer, std::int32_t last_layer) const {
    return group.highest >= height_of_layer(first_layer) && group.lowest <= height_of_layer(last_layer);
  }

  bool is_near_surface(std::size_t node) const {
    // The vertices that it places may be looked for this far from the node.
    constexpr double kReach = 1.3;
    return nodes_.surface_depth[node] <
           nodes_.depth[node] + static_cast<float>(kReach * nodes_.box.lattice.spacing);
  }

  // Not where something else than the region limits the nodes' balls.
  bool has_room_for(const Sphere& own) const {
    const NodeBox& box = nodes_.box;
    const auto middle = box.nearest(own.centre);
    if (!middle) return false;
    const auto [i, j, k] = *middle;
    const double expected = std::min(own.radius - box.lattice.spacing, nodes_.deepest);
    constexpr double kRounding = 1e-8;
    return own.radius >= nodes_.ball_radius && region_.behind_planes(own.centre) >= own.radius - kRounding &&
           nodes_.depth[box.index(i, j, k)] >= static_cast<float>(expected);
  }

  // By nodes that have balls too, which reach as far as its own does.
  bool is_surrounded(std::size_t node) const {
    const std::size_t y = nodes_.box.step_y(), z = nodes_.box.step_z();
    for (const std::size_t layer : {node - z, node, node + z}) {
      for (const std::size_t row : {layer - y, layer, layer + y}) {
        if (!nodes_.has_ball(row - 1) || !nodes_.has_ball(row) || !nodes_.has_ball(row + 1)) return false;
      }
    }
    return true;
  }

  std::vector<RolledBall> balls_of(std::int32_t k) const {
    const NodeBox& box = nodes_.box;
    std::vector<RolledBall> balls;
    for (std::int32_t j = 0; j < box.count_y; ++j) {
      for (std::int32_t i = 0; i < box.count_x; ++i) {
        const std::size_t node = box.index(i, j, k);
        if (!nodes_.is_outermost(node) || is_surrounded(node)) continue;
        const Vec3d at = box.at(i, j, k);
        balls.push_back(
            {at, static_cast<double>(nodes_.depth[node]), nodes_.facet[node], is_near_surface(node)});
        if (const auto ball = ball_in_edge(node, at)) balls.push_back(*ball);
      }
    }
    return balls;
  }

  // Where two or more of what bounds the region are near, a ball in the edge or corner between them.
  std::optional<RolledBall> ball_in_edge(std::size_t node, Vec3d at) const {
    constexpr double kBeyond = 1.5, kFarthest = 2.5, kLeastRadius = 0.9;
    const double spacing = nodes_.box.lattice.spacing, radius = nodes_.ball_radius;
    Halfspaces bounds;
    Vec3d outward{0, 0, 0};
    int near = 0;
    for (const CellPlane& plane : region_.planes()) {
      const double depth = plane.offset - dot(plane.normal, at);
      if (depth >= nodes_.deepest + spacing) continue;
      bounds.add(plane.normal, plane.offset - radius);
      if (depth >= nodes_.deepest) continue;
      outward = outward + plane.normal;
      ++near;
    }
    const std::uint32_t facet = nodes_.facet[node];
    const auto below = static_cast<double>(nodes_.surface_depth[node]);
    if (facet != kNone && below < nodes_.deepest + spacing) {
      const Vec3d foot = region_.nearest_on(facet, at);
      const Vec3d away = normalised(at - foot);
      bounds.add(-away, -(dot(away, foot) + region_.wall() + radius));
      if (below < nodes_.deepest) {
        outward = outward - away;
        ++near;
      }
    }
    if (near < 2) return std::nullopt;
    const Vec3d edge = bounds.nearest_to(at + outward * (kBeyond * spacing));
    if (length(edge - at) > kFarthest * spacing) return std::nullopt;
    double depth = region_.behind_planes(edge);
    const bool asks_surface = below < nodes_.deepest + kFarthest * spacing;
    if (asks_surface) {
      const SurfaceNearby surface = region_.surface_near(edge, region_.wall() + 2 * radius, facet);
      depth = std::min(depth, surface.distance - region_.wall());
    }
    if (depth < kLeastRadius * radius) return std::nullopt;
    return RolledBall{edge, depth, facet, asks_surface};
  }

  // Nodes of some layers.
  void cover(std::uint32_t number, std::int32_t first_layer, std::int32_t last_layer) {
    const NodeBox& box = nodes_.box;
    const RolledBall& ball = opened_.balls[number];
    const double spacing = box.lattice.spacing;
    const double reach = reach_of(ball);
    if (ball.centre.z + reach < height_of_layer(first_layer) ||
        ball.centre.z - reach > height_of_layer(last_layer))
      return;
    const Vec3d origin = box.origin();
    const NodeRange layers(ball.centre.z, reach, origin.z, spacing, box.cut_z, box.count_z);
    for (std::int32_t k = std::max(layers.first, first_layer); k <= std::min(layers.last, last_layer); ++k) {
      const double dz = square(origin.z + spacing * (k + box.cut_z) - ball.centre.z);
      const double reach_y = std::sqrt(std::max(0.0, reach * reach - dz));
      const NodeRange rows(ball.centre.y, reach_y, origin.y, spacing, box.cut_y, box.count_y);
      for (std::int32_t j = rows.first; j <= rows.last; ++j) {
        const double dyz = dz + square(origin.y + spacing * (j + box.cut_y) - ball.centre.y);
        const double reach_x = std::sqrt(std::max(0.0, reach * reach - dyz));
        const NodeRange row(ball.centre.x, reach_x, origin.x, spacing, box.cut_x, box.count_x);
        const std::size_t first = box.index(0, j, k);
        for (std::int32_t i = row.first; i <= row.last; ++i) {
          const std::size_t node = first + static_cast<std::size_t>(i);
          if (nodes_.has_ball(node)) continue;
          const double squared = dyz + square(origin.x + spacing * (i + box.cut_x) - ball.centre.x);
          // Nearer to the middle than the node would have to be for more.
          const double least = ball.radius - static_cast<double>(opened_.cover[node]);
          if (least <= 0 || squared >= least * least) continue;
          const auto cover = static_cast<float>(ball.radius - std::sqrt(squared));
          if (cover <= opened_.cover[node]) continue;
          opened_.cover[node] = cover;
          opened_.ball[node] = number;
        }
      }
    }
  }

  const CellRegion& region_;
  const CellNodes& nodes_;
  OpenedCell& opened_;
};

// Which of the 256 sets of corners of a cube are well-composed: neither they nor the others meet diagonally.
std::array<bool, 256> make_well_composed() {
  const auto hangs_together = [](unsigned corners) {
    if (corners == 0) return true;
    unsigned seen = corners & (~corners + 1);
    for (bool grows = true; grows;) {
      grows = false;
      for (unsigned corner = 0; corner < 8; ++corner) {
        if ((corners >> corner & 1U) == 0 || (seen >> corner & 1U) != 0) continue;
        for (unsigned axis = 0; axis < 3; ++axis) {
          if ((seen >> (corner ^ (1U << axis)) & 1U) == 0) continue;
          seen |= 1U << corner;
          grows = true;
        }
      }
    }
    return seen == corners;
  };
  const auto has_diagonal_face = [](unsigned corners) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      const unsigned u = 1U << (axis + 1) % 3, v = 1U << (axis + 2) % 3;
      for (unsigned base = 0; base < 2; ++base) {
        const auto has = [&](unsigned corner) { return (corners >> (base << axis | corner) & 1U) != 0; };
        if (has(0) == has(u | v) && has(u) == has(v) && has(0) != has(u)) return true;
      }
    }
    return false;
  };
  std::array<bool, 256> result{};
  for (unsigned corners = 0; corners < 256; ++corners)
    result[corners] =
        hangs_together(corners) && hangs_together(~corners & 255U) && !has_diagonal_face(corners);
  return result;
}

// Of the cubes of one row that begin at node `i` or after, the first whose corners are not all in the void, nor all out of
// it; or the row's last one or after. Many nodes at a time. `rows`: of the first corners, and those along y and z.
std::size_t next_mixed(const std::array<const std::uint8_t*, 4>& rows, std::size_t i, std::size_t count) {
  constexpr std::size_t kAtOnce = 8;
  constexpr std::uint64_t kAllSet = 0x0101010101010101;
  for (; i + kAtOnce <= count; i += kAtOnce - 1) {
    std::uint64_t any = 0, all = kAllSet;
    for (const std::uint8_t* row : rows) {
      std::uint64_t nodes = 0;
      std::memcpy(&nodes, row + i, kAtOnce);
      any |= nodes;
      all &= nodes;
    }
    if (any != 0 && all != kAllSet) return i;
  }
  return i;
}

// Takes nodes out of the void until every cube is well-composed: those without a ball of their own, or, where nodes
// with one meet diagonally since the nodes between them were taken out, these.
void make_well_composed(const CellNodes& nodes, std::vector<std::uint8_t>& is_void, SharedWork& work) {
  static const std::array<bool, 256> kWellComposed = make_well_composed();
  const NodeBox& box = nodes.box;
  const auto rows = static_cast<std::size_t>(box.count_y), length = static_cast<std::size_t>(box.count_x);
  // Of each row of nodes, the number of the look at a row of cubes by which some were taken out; of each row of cubes, of
  // its last look: what has not changed since is well-composed.
  std::vector<std::size_t> changed(rows * static_cast<std::size_t>(box.count_z), 1), seen(changed.size(), 0);
  std::size_t looks = 1;
  for (bool changes = true; changes;) {
    changes = false;
    for (std::int32_t k = 0; k + 1 < box.count_z; ++k) {
      work.check_interrupted();
      for (std::int32_t j = 0; j + 1 < box.count_y; ++j) {
        const std::size_t at = static_cast<std::size_t>(k) * rows + static_cast<std::size_t>(j);
        if (std::max({changed[at], changed[at + 1], changed[at + rows], changed[at + rows + 1]}) <= seen[at])
          continue;
        seen[at] = ++looks;
        const std::array<std::size_t, 8> first = cube_at(box, 0, j, k);
        const std::array<const std::uint8_t*, 4> of_row{&is_void[first[0]], &is_void[first[2]],
                                                        &is_void[first[4]], &is_void[first[6]]};
        for (std::size_t i = next_mixed(of_row, 0, length); i + 1 < length;
             i = next_mixed(of_row, i + 1, length)) {
          unsigned set = 0;
          for (unsigned corner = 0; corner < 8; ++corner)
            set |= (is_void[first[corner] + i] != 0 ? 1U : 0U) << corner;
          if (kWellComposed[set]) continue;
          const bool has_others = std::ranges::any_of(first, [&](std::size_t corner) {
            return is_void[corner + i] != 0 && !nodes.has_ball(corner + i);
          });
          for (const std::size_t corner : first) {
            if (!has_others || !nodes.has_ball(corner + i)) is_void[corner + i] = 0;
          }
          // Also those of this row that were looked at before.
          for (const std::size_t row : {at, at + 1, at + rows, at + rows + 1}) changed[row] = looks + 1;
          changes = true;
        }
      }
    }
  }
}

// Void nodes that follow each other along x.
struct Run {
  std::size_t first, last;
};

std::vector<Run> runs_of(const NodeBox& box, const std::vector<std::uint8_t>& is_void) {
  std::vector<Run> runs;
  for (std::size_t row = 0; row < box.size(); row += box.step_y()) {
    for (std::size_t node = row; node < row + box.step_y(); ++node) {
      if (is_void[node] == 0) continue;
      const std::size_t first = node;
      while (node + 1 < row + box.step_y() && is_void[node + 1] != 0) ++node;
      runs.push_back({first, node});
    }
  }
  return runs;
}

}  // namespace

OpenedCell open_cell(const CellRegion& region, const CellNodes& nodes, const Sphere& own, SharedWork& work) {
  OpenedCell opened;
  opened.cover.assign(nodes.box.size(), kUncovered);
  opened.ball.assign(nodes.box.size(), kNone);
  Roller(region, nodes, opened).roll(own, work);
  const auto least = kLeastCover * static_cast<float>(nodes.box.lattice.spacing);
  opened.is_void.resize(nodes.box.size());
  constexpr std::size_t kGrain = std::size_t{1} << 16;
  work.for_each(nodes.box.size(), kGrain, [&](std::size_t node) {
    opened.is_void[node] = nodes.has_ball(node) || opened.cover[node] > least ? 1 : 0;
  });
  make_well_composed(nodes, opened.is_void, work);
  return opened;
}

std::vector<NodePiece> find_pieces(const NodeBox& box, const std::vector<std::uint8_t>& is_void,
                                   std::vector<std::int32_t>& labels) {
  // By runs of nodes along x, joined with those they touch in the rows before.
  const std::vector<Run> runs = runs_of(box, is_void);
  DisjointSets sets(runs.size());
  labels.assign(box.size(), -1);
  for (std::uint32_t n = 0; n < runs.size(); ++n) {
    const auto [first, last] = runs[n];
    for (const std::size_t back : {box.step_y(), box.step_z()}) {
      std::int32_t before = -1;
      for (std::size_t node = first; node <= last; ++node) {
        const std::int32_t other = labels[node - back];
        if (other >= 0 && other != before) sets.join(n, static_cast<std::uint32_t>(other));
        before = other;
      }
    }
    std::fill(labels.begin() + static_cast<std::ptrdiff_t>(first),
              labels.begin() + static_cast<std::ptrdiff_t>(last) + 1, static_cast<std::int32_t>(n));
  }
  std::vector<NodePiece> pieces;
  std::vector<std::int32_t> piece_of(runs.size(), -1);
  for (std::uint32_t n = 0; n < runs.size(); ++n) {
    const auto [first, last] = runs[n];
    std::int32_t& label = piece_of[sets.root(n)];
    if (label < 0) {
      label = static_cast<std::int32_t>(pieces.size());
      pieces.push_back({label, 0});
    }
    pieces[static_cast<std::size_t>(label)].size += last - first + 1;
    std::fill(labels.begin() + static_cast<std::ptrdiff_t>(first),
              labels.begin() + static_cast<std::ptrdiff_t>(last) + 1, label);
  }
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const NodePiece& a, const NodePiece& b) { return a.size > b.size; });
  return pieces;
}

}  // namespace aerate
