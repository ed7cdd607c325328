#include "packing/cells/cell_drainage_holes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <queue>
#include <tbb/parallel_for.h>
#include <utility>

#include "core/facet_distance.h"
#include "kernels/constants.h"
#include "packing/hole_rules.h"

namespace aerate {
namespace {

// Nodes from which ways are looked for at once.
constexpr std::size_t kAtOnce = 32;

// Of the nodes that holes which were asked for may start from, so many of each void are looked at.
constexpr std::size_t kMostStarts = 256;

// Level ones besides, for tubes out of the side of a void.
std::vector<Vec3d> directions_and_level_ones(Vec3d axis) {
  constexpr int kLevel = 24;
  const TubeFrame frame = frame_of({{0, 0, 0}, axis, 1}, {0, 0, 1});
  std::vector<Vec3d> directions = directions_about(axis);
  for (int i = 0; i < kLevel; ++i) {
    const double angle = 2 * std::numbers::pi * i / kLevel;
    directions.push_back(frame.down * std::cos(angle) + frame.across * std::sin(angle));
  }
  return directions;
}

}  // namespace

CellHoleWays::CellHoleWays(const DrainableModel& model, const CellVoids& cells,
                           const std::vector<VoidHollows>& hollows, const PackingLimits& limits,
                           double radius, const CellSurfaces& surfaces, const HoleSides& sides)
    : cells_(cells),
      hollows_(hollows),
      up_(limits.roof.up),
      tubes_(hollows, limits, radius, surfaces, model.outward),
      directions_{directions_and_level_ones(-up_), directions_and_level_ones(up_)} {
  // Below a roof few tubes lead upwards, and none where the top is ruled out: one from high up that leads down is still a high one.
  const bool is_top_ruled_out =
      std::ranges::any_of(sides.not_on, [&](Vec3d side) { return dot(side, up_) > std::numbers::sqrt2 / 2; });
  if (limits.roof.limits_ceilings() || is_top_ruled_out) {
    std::vector<Vec3d>& high = directions_[kUpsideDown];
    high.insert(high.end(), directions_[kUpright].begin(), directions_[kUpright].end());
  }
}

CellHoleWays::Known CellHoleWays::known(const Start& start) {
  const auto [known, is_new] = known_.try_emplace(start);
  return {&known->second, is_new};
}

// From just above a node on the floor of a hollow, or from so high above it that a tube down has room.
CellHoleWays::Ways CellHoleWays::look_from(const Start& start) const {
  const Vec3d up = start.orientation == kUpright ? up_ : -up_;
  const Vec3d at = hollows_[start.from].nodes().at(start.node);
  const double ball = cells_.ball_radius, radius = tubes_.radius();
  Ways ways;
  for (const Vec3d direction : directions_[start.orientation]) {
    const double lowered = radius * lean_of(direction, up);
    const bool leads_down = dot(direction, up) < -0.5;
    for (const double above : {0.2 * ball + 0.1, std::max(ball, radius) + 0.1}) {
      const auto way = tubes_.follow(start.from, at + up * (lowered + above), direction);
      if (way) ways.push_back(*way);
      if (way || !leads_down) break;
    }
  }
  return ways;
}

CellHolePlaces::CellHolePlaces(const DrainableModel& model, const CellVoids& cells,
                               const std::vector<VoidHollows>& hollows, const PackingLimits& limits,
                               const DrainageRequest& request, const CellSurfaces& surfaces,
                               CellHoleWays& ways)
    : cells_(cells),
      hollows_(hollows),
      limits_(limits),
      surfaces_(surfaces),
      outward_(model.outward),
      ways_(ways),
      ways_out_(ways.tubes()),
      showing_(surfaces.model(), limits.roof.up, model.plate, request),
      avoids_plate_(request.avoids_plate),
      worth_of_hiding_(request.worth_of_hiding) {}

bool CellHolePlaces::is_allowed(CellWayOut& way) const {
  if (avoids_plate_) {
    if (!way.reaches_plate) way.reaches_plate = showing_.reaches_plate(way.hole.tube);
    if (*way.reaches_plate) return false;
  }
  if (!way.is_on_sides) way.is_on_sides = showing_.is_on_sides(way.hole.tube);
  return *way.is_on_sides;
}

// The best way first. What those from a node cost at least is known before they are looked for.
class CellHolePlaces::Ranking {
 public:
  Ranking(CellHolePlaces& places, std::size_t orientation, double height)
      : places_(places),
        up_(orientation == kUpright ? places.limits_.roof.up : -places.limits_.roof.up),
        orientation_(orientation),
        height_(height) {}

  void push(std::uint32_t from, std::uint32_t node) {
    const VoidNodes& nodes = places_.hollows_[from].nodes();
    const Vec3d at = nodes.at(node);
    const double reach = 2 * places_.ways_out_.longest();
    if (places_.surfaces_.model().to_surface(at, reach) >= reach) return;
    const double least = dot(at, up_) - nodes.lattice.spacing + kLengthWeight * places_.limits_.wall;
    queue_.push({least, sequence_++, from, node, nullptr});
  }

  // How much a way shows is only looked at where it may be the best.
  CellWayOut* next() {
    while (!queue_.empty()) {
      const Entry best = queue_.top();
      if (best.way == nullptr) {
        look();
        continue;
      }
      queue_.pop();
      if (best.way->showing) return best.way;
      best.way->showing = places_.showing_.of(best.way->hole.tube);
      queue_.push({cost_of(*best.way), best.sequence, best.from, best.node, best.way});
    }
    return nullptr;
  }

 private:
  struct Entry {
    double cost;
    std::size_t sequence;
    std::uint32_t from, node;
    CellWayOut* way;  // null: all those from the node
    friend bool operator<(const Entry& a, const Entry& b) {
      return std::tie(a.cost, a.sequence) > std::tie(b.cost, b.sequence);
    }
  };

  // Looks for the ways from the next nodes.
  void look() {
    std::vector<Entry> nodes;
    while (!queue_.empty() && queue_.top().way == nullptr && nodes.size() < kAtOnce) {
      nodes.push_back(queue_.top());
      queue_.pop();
    }
    // Nodes of several hollows may be the same.
    std::map<Ways*, std::optional<CellHoleWays::Start>> looked_at;  // those that are still to be looked for
    std::vector<Ways*> ways_of;
    for (const Entry& entry : nodes) {
      const CellHoleWays::Start start{orientation_, entry.from, entry.node};
      const auto [ways, is_new] = places_.ways_.known(start);
      ways_of.push_back(ways);
      looked_at.try_emplace(ways, is_new ? std::optional(start) : std::nullopt);
    }
    const std::vector<std::pair<Ways*, std::optional<CellHoleWays::Start>>> each(looked_at.begin(),
                                                                                 looked_at.end());
    tbb::parallel_for(std::size_t{0}, each.size(), [&](std::size_t i) {
      const auto& [ways, start] = each[i];
      if (start) *ways = places_.ways_.look_from(*start);
      for (CellWayOut& way : *ways) places_.is_allowed(way);
    });
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      for (CellWayOut& way : *ways_of[i])
        if (places_.is_allowed(way))
          queue_.push({cost_of(way), sequence_++, nodes[i].from, nodes[i].node, &way});
    }
  }

  double cost_of(const CellWayOut& way) const {
    return places_.ways_out_.sill_of(way, orientation_) +
           places_.worth_of_hiding_ * height_ * way.showing.value_or(0) + kLengthWeight * way.length();
  }

  CellHolePlaces& places_;
  Vec3d up_;
  std::size_t orientation_;
  double height_;
  std::size_t sequence_ = 0;
  std::priority_queue<Entry> queue_;
};

std::optional<CellHole> CellHolePlaces::best(std::span<const Basin::Part> hollows, std::size_t orientation,
                                             double share, const Accept& accept) {
  double lowest = kInfinity, highest = -kInfinity;
  for (const Basin::Part& part : hollows) {
    const VoidHollows& own = hollows_[part.in];
    lowest = std::min(lowest, own.in(orientation).bottom[part.hollow]);
    for (const double bottom : own.in(1 - orientation).bottom) highest = std::max(highest, -bottom);
  }
  const double height = highest - lowest;
  Ranking ranking(*this, orientation, height);
  for (const Basin::Part& part : hollows) {
    const Hollows& own = hollows_[part.in].in(orientation);
    if (own.bottom[part.hollow] > lowest + share * height) continue;
    for (const std::uint32_t node : own.floor[part.hollow]) ranking.push(part.in, node);
  }
  while (CellWayOut* way = ranking.next()) {
    if (!way->is_sound) way->is_sound = ways_out_.is_sound(*way);
    if (!*way->is_sound) continue;
    if (!way->made) way->made = std::make_shared<const CellHole>(ways_out_.hole_of(*way));
    if (accept(*way->made)) return *way->made;
  }
  return std::nullopt;
}

std::optional<CellHole> CellHolePlaces::leading_to(Vec3d place, std::span<const std::uint32_t> voids,
                                                   const Accept& accept) const {
  const Vec3d on_surface = on_surface_near(place, 2 * ways_out_.radius(), surfaces_.model(), outward_);
  if (!surfaces_.model().keeps_off_kept({on_surface, on_surface, ways_out_.radius()})) return std::nullopt;
  Ways ways;
  for (const std::uint32_t from : voids) {
    const VoidNodes& nodes = hollows_[from].nodes();
    // Nodes that were put together may lie just outside of the cell.
    const double reach = ways_out_.longest() + 2 * nodes.lattice.spacing;
    const Box3d& box = cells_.planes.boxes[cells_.voids[from].cell];
    if (distance_squared(box, {on_surface, on_surface}) > reach * reach) continue;
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      const double distance = length(nodes.at(i) - on_surface);
      if (distance < ways_out_.longest()) near.emplace_back(distance, i);
    }
    std::sort(near.begin(), near.end());
    const std::size_t step = near.size() / kMostStarts + 1;
    for (std::size_t i = 0; i < near.size(); i += step) {
      const Vec3d inside = nodes.at(near[i].second);
      if (near[i].first <= 0) continue;
      const auto found = ways_out_.follow(from, inside, (on_surface - inside) * (1 / near[i].first));
      if (found && length(found->hole.tube.end - on_surface) < ways_out_.radius()) ways.push_back(*found);
    }
  }
  std::stable_sort(ways.begin(), ways.end(),
                   [](const CellWayOut& a, const CellWayOut& b) { return a.length() < b.length(); });
  for (const CellWayOut& way : ways) {
    if (!ways_out_.is_sound(way)) continue;
    CellHole hole = ways_out_.hole_of(way);
    if (accept(hole)) return hole;
  }
  return std::nullopt;
}

}  // namespace aerate
