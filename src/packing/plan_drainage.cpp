#include "packing/plan_drainage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include "core/disjoint_sets.h"
#include "core/error.h"
#include "packing/channel_ways.h"
#include "packing/flood.h"
#include "packing/hole_places.h"
#include "packing/pools.h"
#include "packing/tube_clearance.h"
#include "packing/tube_through.h"

namespace aerate {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// No channel is longer than the largest void's radius, or this many channel diameters.
constexpr double kLongestInDiameters = 4;

// Sound places where the surface turned out not to be cut well, for one escape hole, before it is given up:
// first in this share of the network's height, then anywhere.
constexpr int kMostCuts = 100;
constexpr std::array<double, 2> kSharesOfHeight{0.3, 1};

// A network is opened where channels reach this share of its volume, or the most of so many attempts.
constexpr double kEnoughReached = 0.8;
constexpr int kMostAttempts = 16;

// Of the voids' volume: more holes and channels are made while more than this stays after both orientations,
// at most so many holes, each for a pool of at least that size.
constexpr double kPoolsAimedAt = 0.01;
constexpr int kMostMoreHoles = 24;
constexpr double kPoolWorthHole = 0.003;

// More channels than the tree's have to reduce what stays to this share of it.
constexpr double kLeastGain = 0.7;

// A void that keeps more than this share of its volume in print orientation is worth a way out upside down.
constexpr double kPoolWorthWay = 0.01;

std::string shortened(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

// Gives holes one by one, the best first; nullopt when there are no more.
using HoleSource = std::function<std::optional<EscapeHole>()>;

HoleSource in_order(std::span<const EscapeHole> holes) {
  return [holes]() mutable {
    std::optional<EscapeHole> next;
    if (!holes.empty()) {
      next = holes.front();
      holes = holes.subspan(1);
    }
    return next;
  };
}

class Planner {
 public:
  Planner(const DrainableModel& model, const Packing& packing, const DrainageRequest& request,
          const CanOpen& can_open, Monitor& monitor)
      : spheres_(packing.spheres),
        request_(request),
        roof_(packing.limits.roof),
        can_open_(can_open),
        monitor_(monitor),
        longest_(std::max(largest_radius(), kLongestInDiameters * 2 * request.channel_radius)),
        clearance_(model.surface, spheres_, packing.limits,
                   std::max(longest_, longest_hole(request, packing.limits)),
                   std::max(request.channel_radius, request.hole_radius)),
        ways_(spheres_, roof_, request.channel_radius, longest_, clearance_, monitor),
        places_(model.outward, spheres_, packing.limits, request, clearance_) {
    plan_.roof = roof_;
  }

  // Throws as `plan_drainage` does.
  PlannedDrainage run();

 private:
  using Members = std::vector<std::uint32_t>;
  using UncutPlace = std::tuple<std::uint32_t, double, double, double>;

  double largest_radius() const;
  double volume_of(const Members& members) const;
  std::vector<Members> networks();
  std::vector<Members> asked_for(std::vector<Members> networks);
  bool has_low_hole(const Members& members, std::uint32_t network) const;
  bool is_open(std::size_t way);
  bool leaves_room_for_channel(const EscapeHole& hole);
  std::ptrdiff_t holes_of(std::uint32_t network) const;
  void leave_out(std::uint32_t network);
  void drop_tubes_of_left_out();
  bool open_network(const Members& members, std::uint32_t network);
  void open_and_join(std::span<const Members> networks, double whole_volume);
  bool open_one(const HoleSource& next_best, std::uint32_t network);
  bool open(const Members& members, Vec3d down, std::uint32_t network);
  std::vector<FloodStep> flooded(Vec3d up, const std::function<void(const Channel&)>& join);
  void place(const Channel& channel);
  void take_back_channels();
  void open_pools(double whole_volume);
  void empty_pools();
  TrappedPools pools_now() const { return compacted().plan.pools; }
  void leave_out_pools();
  bool regroup();
  PlannedDrainage compacted() const;

  std::span<const Sphere> spheres_;
  const DrainageRequest& request_;
  Roof roof_;
  const CanOpen& can_open_;
  Monitor& monitor_;
  double longest_;
  TubeClearance clearance_;
  ChannelWays ways_;
  HolePlaces places_;
  DrainagePlan plan_;
  UndrainedVoids dropped_;
  std::vector<std::uint32_t> network_of_;
  std::vector<std::uint32_t> asked_for_;  // voids with holes that were asked for
  std::set<UncutPlace> uncut_;            // where the surface is known not to be cut well
};

double Planner::largest_radius() const {
  double largest = 0;
  for (const Sphere& sphere : spheres_) largest = std::max(largest, sphere.radius);
  return largest;
}

double Planner::volume_of(const Members& members) const {
  double volume = 0;
  for (const std::uint32_t i : members) volume += void_volume(roof_, spheres_[i].radius);
  return volume;
}

// Sets of voids that channels can join, by falling volume; voids that are too narrow are counted.
std::vector<Planner::Members> Planner::networks() {
  std::vector<bool> is_wide(spheres_.size());
  for (std::uint32_t i = 0; i < spheres_.size(); ++i) {
    is_wide[i] = request_.channel_radius <= kWidestTubeShare * spheres_[i].radius;
    if (is_wide[i]) continue;
    ++dropped_.narrow;
    dropped_.volume += volume_of({i});
  }
  struct Pair {
    double gap;
    std::size_t first, last;  // of the ways between the two
  };
  std::vector<Pair> pairs;
  for (std::size_t first = 0, last = 0; first < ways_.size(); first = last) {
    const std::uint32_t from = ways_[first].channel.from, to = ways_[first].channel.to;
    while (last < ways_.size() && ways_[last].channel.from == from && ways_[last].channel.to == to) ++last;
    const double apart = length(spheres_[from].centre - spheres_[to].centre);
    if (is_wide[from] && is_wide[to])
      pairs.push_back({apart - spheres_[from].radius - spheres_[to].radius, first, last});
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& p, const Pair& q) { return std::tie(p.gap, p.first) < std::tie(q.gap, q.first); });
  DisjointSets sets(spheres_.size());
  for (const Pair& pair : pairs) {
    const std::uint32_t from = ways_[pair.first].channel.from, to = ways_[pair.first].channel.to;
    if (sets.root(from) == sets.root(to)) continue;
    monitor_.check_interrupted();
    for (std::size_t way = pair.first; way < pair.last; ++way) {
      if (!ways_.is_free(way)) continue;
      sets.join(from, to);
      break;
    }
  }
  std::vector<Members> by_root(spheres_.size());
  for (std::uint32_t i = 0; i < spheres_.size(); ++i) {
    if (is_wide[i]) by_root[sets.root(i)].push_back(i);
  }
  std::erase_if(by_root, [](const Members& members) { return members.empty(); });
  std::stable_sort(by_root.begin(), by_root.end(),
                   [&](const Members& a, const Members& b) { return volume_of(a) > volume_of(b); });
  return by_root;
}

// Opens the networks at the places that were asked for; those that no such place reaches are left out if two
// or more were.
std::vector<Planner::Members> Planner::asked_for(std::vector<Members> networks) {
  if (request_.escape_holes.empty()) return networks;
  std::vector<std::uint32_t> network_of(spheres_.size(), kOutside);
  Members all;
  for (std::uint32_t n = 0; n < networks.size(); ++n) {
    for (const std::uint32_t i : networks[n]) network_of[i] = n;
    all.insert(all.end(), networks[n].begin(), networks[n].end());
  }
  std::sort(all.begin(), all.end());
  std::vector<bool> is_reached(networks.size(), false);
  for (const Vec3d place : request_.escape_holes) {
    // Rather into a void beside which the hole leaves room for a channel.
    const std::vector<EscapeHole> found = places_.leading_to(place, all);
    std::vector<EscapeHole> roomy = found;
    std::erase_if(roomy, [this](const EscapeHole& hole) { return !leaves_room_for_channel(hole); });
    if (!open_one(in_order(roomy), 0) && !open_one(in_order(found), 0)) {
      throw UsageError("no straight hole leads from (" + std::to_string(place.x) + ", " +
                           std::to_string(place.y) + ", " + std::to_string(place.z) +
                           ") mm to a void that channels join to others",
                       "ask for a place nearer to a large void, give a smaller --hole-diameter, or leave "
                       "--escape-hole out");
    }
    asked_for_.push_back(plan_.holes.back().from);
    is_reached[network_of[plan_.holes.back().from]] = true;
  }
  std::vector<Members> reached;
  std::vector<std::uint32_t> renumbered(networks.size(), kOutside);
  for (std::size_t n = 0; n < networks.size(); ++n) {
    if (is_reached[n] || request_.escape_holes.size() < 2) {
      renumbered[n] = static_cast<std::uint32_t>(reached.size());
      reached.push_back(std::move(networks[n]));
    } else {
      dropped_.unopened += networks[n].size();
      dropped_.volume += volume_of(networks[n]);
    }
  }
  for (EscapeHole& hole : plan_.holes) hole.network = renumbered[network_of[hole.from]];
  return reached;
}

// Can the channel of a way still be placed?
bool Planner::is_open(std::size_t way) {
  const Channel& channel = ways_[way].channel;
  return ways_.is_free(way) && clearance_.keeps_gap_to_tubes(channel.tube, channel.from, channel.to);
}

// Can a channel still lead from the hole's void to a neighbour?
bool Planner::leaves_room_for_channel(const EscapeHole& hole) {
  clearance_.place(hole.tube, hole.from, hole.from);
  const std::span<const std::uint32_t> ways = ways_.of(hole.from);
  const bool found =
      std::any_of(ways.begin(), ways.end(), [this](std::uint32_t way) { return is_open(way); });
  clearance_.take_back_last();
  return found;
}

bool Planner::open_one(const HoleSource& next_best, std::uint32_t network) {
  int cuts = 0;
  while (auto found = next_best()) {
    EscapeHole& hole = *found;
    monitor_.check_interrupted();
    if (!places_.is_sound(hole)) continue;
    const Vec3d end = hole.tube.end;
    const UncutPlace place{hole.from, end.x, end.y, end.z};
    if (uncut_.contains(place)) continue;
    if (++cuts > kMostCuts) return false;
    if (!can_open_(hole)) {
      uncut_.insert(place);
      continue;
    }
    hole.network = network;
    clearance_.place(hole.tube, hole.from, hole.from);
    plan_.holes.push_back(hole);
    return true;
  }
  return false;
}

// Opens some of the voids where liquid that runs `down` leaves them.
bool Planner::open(const Members& members, Vec3d down, std::uint32_t network) {
  return std::any_of(kSharesOfHeight.begin(), kSharesOfHeight.end(), [&](double share) {
    HolePlaces::Ranking ranking = places_.ranked(members, down, share);
    return open_one([&] { return ranking.next(); }, network);
  });
}

std::ptrdiff_t Planner::holes_of(std::uint32_t network) const {
  return std::count_if(plan_.holes.begin(), plan_.holes.end(),
                       [network](const EscapeHole& hole) { return hole.network == network; });
}

// Is there a hole in the lower half of the network, or are there two anywhere?
bool Planner::has_low_hole(const Members& members, std::uint32_t network) const {
  double lowest = kInfinity, highest = -kInfinity;
  for (const std::uint32_t i : members) {
    const double height = dot(spheres_[i].centre, roof_.up);
    lowest = std::min(lowest, height - spheres_[i].radius);
    highest = std::max(highest, height + spheres_[i].radius);
  }
  std::size_t count = 0;
  for (const EscapeHole& hole : plan_.holes) {
    if (hole.network != network) continue;
    if (dot(hole.tube.end, roof_.up) < (lowest + highest) / 2) return true;
    ++count;
  }
  return count >= 2;
}

void Planner::leave_out(std::uint32_t network) {
  for (std::uint32_t i = 0; i < spheres_.size(); ++i) {
    if (network_of_[i] != network) continue;
    network_of_[i] = kOutside;
    ++dropped_.unopened;
    dropped_.volume += volume_of({i});
  }
  drop_tubes_of_left_out();
}

void Planner::drop_tubes_of_left_out() {
  const auto is_left_out = [this](std::uint32_t i) { return network_of_[i] == kOutside; };
  std::erase_if(plan_.holes, [&](const EscapeHole& hole) { return is_left_out(hole.from); });
  std::erase_if(plan_.channels, [&](const Channel& c) { return is_left_out(c.from) || is_left_out(c.to); });
}

// Opens a network below and above, before channels take the room for it: at balls from which most of it can
// be reached. False if there is no place below.
bool Planner::open_network(const Members& members, std::uint32_t network) {
  const bool is_asked_for_below = has_low_hole(members, network);
  Members candidates = members;
  std::vector<EscapeHole> best;
  double most = 0;
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    const std::size_t before = plan_.holes.size();
    if (!is_asked_for_below && !open(candidates, -roof_.up, network)) break;
    if (holes_of(network) < 2) open(candidates, roof_.up, network);
    const std::vector<FloodStep> ways = flooded(roof_.up, [this](const Channel& channel) { place(channel); });
    take_back_channels();
    Members reached;
    for (const std::uint32_t i : members) {
      if (ways[i].to != kOutside) reached.push_back(i);
    }
    const double volume = volume_of(reached);
    if (volume > most) {
      most = volume;
      best.assign(plan_.holes.begin() + static_cast<std::ptrdiff_t>(before), plan_.holes.end());
    }
    std::vector<std::uint32_t> useless;
    for (std::size_t i = before; i < plan_.holes.size(); ++i) {
      const bool is_below = i == before && !is_asked_for_below;
      if (is_below ? volume < kEnoughReached * volume_of(members) : ways[plan_.holes[i].from].to == kOutside)
        useless.push_back(plan_.holes[i].from);
    }
    while (plan_.holes.size() > before) {
      plan_.holes.pop_back();
      clearance_.take_back_last();
    }
    if (useless.empty()) break;
    std::erase_if(candidates, [&](std::uint32_t i) {
      return std::find(useless.begin(), useless.end(), i) != useless.end();
    });
  }
  for (const EscapeHole& hole : best) {
    clearance_.place(hole.tube, hole.from, hole.from);
    plan_.holes.push_back(hole);
  }
  return holes_of(network) > 0;
}

// Opens the networks that are worth it below, joins their voids, and opens them above.
void Planner::open_and_join(std::span<const Members> networks, double whole_volume) {
  for (std::uint32_t n = 0; n < networks.size(); ++n) {
    for (const std::uint32_t i : networks[n]) network_of_[i] = n;
    const bool is_worth_it = holes_of(n) > 0 || volume_of(networks[n]) >= kLeastNetworkShare * whole_volume;
    if (!is_worth_it || !open_network(networks[n], n)) leave_out(n);
  }
  const std::vector<FloodStep> ways = flooded(roof_.up, [this](const Channel& channel) { place(channel); });
  for (std::uint32_t n = 0; n < networks.size(); ++n) {
    Members reached;
    for (const std::uint32_t i : networks[n]) {
      if (network_of_[i] == n && ways[i].to != kOutside) reached.push_back(i);
    }
    std::erase_if(plan_.holes, [&](const EscapeHole& hole) {
      return hole.network == n && ways[hole.from].to == kOutside;
    });
    if (reached.empty()) continue;
    if (holes_of(n) >= 2 || open(reached, roof_.up, n)) {
      ++plan_.network_count;
      for (const std::uint32_t i : networks[n]) {
        if (ways[i].to != kOutside) continue;
        network_of_[i] = kOutside;
        ++dropped_.unreached;
        dropped_.volume += volume_of({i});
      }
    } else {
      leave_out(n);
    }
  }
}

// Floods all networks, along channels that are there and those that can still be placed. `join` is called for
// each of the latter that is the last to a void.
std::vector<FloodStep> Planner::flooded(Vec3d up, const std::function<void(const Channel&)>& join) {
  return flood({spheres_, network_of_, plan_, ways_}, up, [&](std::size_t way) {
    if (!is_open(way)) return false;
    monitor_.check_interrupted();
    join(ways_[way].channel);
    return true;
  });
}

void Planner::place(const Channel& channel) {
  clearance_.place(channel.tube, channel.from, channel.to);
  plan_.channels.push_back(channel);
}

void Planner::take_back_channels() {
  for (; !plan_.channels.empty(); plan_.channels.pop_back()) clearance_.take_back_last();
}

// Opens the largest pools below, until little stays.
void Planner::open_pools(double whole_volume) {
  for (int more = 0; more < kMostMoreHoles; ++more) {
    if (pools_now().after_both <= kPoolsAimedAt * whole_volume) return;
    bool opened = false;
    for (const Pool& pool : upright_pools(spheres_, plan_)) {
      if (pool.volume < kPoolWorthHole * whole_volume) return;
      opened = open(pool.voids, -roof_.up, network_of_[pool.voids.front()]);
      if (opened) break;
    }
    if (!opened) return;
  }
}

// Voids at the foot of a branch stay full in print orientation, and upside down the tree, which was made for
// print orientation, may not lead from there to the high hole. Adds the channels that do, beside the tree.
void Planner::empty_pools() {
  const std::size_t tree_size = plan_.channels.size();
  const double before = pools_now().after_both;
  const SpillHeights upright = spill_heights(spheres_, plan_, roof_.up);
  const std::vector<FloodStep> ways = flooded(-roof_.up, [](const Channel&) {});
  std::vector<bool> is_on_way(spheres_.size(), false);
  for (std::uint32_t i = 0; i < spheres_.size(); ++i) {
    if (network_of_[i] == kOutside || upright.height[i] == kInfinity) continue;
    const double left = volume_below(roof_, spheres_[i], roof_.up, upright.height[i]);
    if (left < kPoolWorthWay * volume_of({i})) continue;
    for (std::uint32_t at = i; at != kOutside && ways[at].to != kOutside && !is_on_way[at];
         at = ways[at].from)
      is_on_way[at] = true;
  }
  for (std::uint32_t i = 0; i < spheres_.size(); ++i) {
    if (!is_on_way[i] || ways[i].way == kExistingChannel) continue;
    if (is_open(ways[i].way)) place(ways_[ways[i].way].channel);
  }
  // Not worth it: back to the tree.
  if (pools_now().after_both > kLeastGain * before) plan_.channels.resize(tree_size);
}

// Branches of which the largest share stays full are not made, until little stays.
void Planner::leave_out_pools() {
  for (std::size_t round = 0; round < spheres_.size(); ++round) {
    const TrappedPools pools = pools_now();
    if (pools.after_both <= kPoolsAimedAt * pools.total) return;
    const SpillHeights spills = spill_heights(spheres_, plan_, roof_.up);
    const std::uint32_t chosen = fullest_branch(spheres_, plan_, spills, asked_for_, kPoolsAimedAt);
    if (chosen == kOutside) return;
    for (const std::uint32_t i : branch_of(chosen, spills)) {
      network_of_[i] = kOutside;
      ++dropped_.full;
      dropped_.volume += volume_of({i});
    }
    drop_tubes_of_left_out();
  }
}

// Numbers the sets of voids that are joined anew, since leaving out may have cut some in two, and gives each
// a second hole or leaves it out. Was one left out?
bool Planner::regroup() {
  DisjointSets sets(spheres_.size());
  for (const Channel& channel : plan_.channels) sets.join(channel.from, channel.to);
  std::map<std::size_t, std::uint32_t> number_of_root;
  std::vector<Members> groups;
  for (std::uint32_t i = 0; i < spheres_.size(); ++i) {
    if (network_of_[i] == kOutside) continue;
    const auto [place, is_new] =
        number_of_root.try_emplace(sets.root(i), static_cast<std::uint32_t>(groups.size()));
    if (is_new) groups.emplace_back();
    network_of_[i] = place->second;
    groups[place->second].push_back(i);
  }
  for (EscapeHole& hole : plan_.holes) hole.network = network_of_[hole.from];
  bool has_left_out = false;
  for (std::uint32_t n = 0; n < groups.size(); ++n) {
    if (holes_of(n) >= 2) continue;
    const Vec3d missing = has_low_hole(groups[n], n) ? roof_.up : -roof_.up;
    if (open(groups[n], missing, n)) continue;
    leave_out(n);
    has_left_out = true;
  }
  return has_left_out;
}

PlannedDrainage Planner::run() {
  std::vector<Members> found = networks();
  if (found.empty()) {
    throw UsageError("a channel of " + shortened(2 * request_.channel_radius) +
                         " mm is too wide for every void: the largest has a diameter of " +
                         shortened(2 * largest_radius()) + " mm",
                     "give a smaller --channel-diameter, or larger voids with --max-radius");
  }
  double whole = 0;
  for (const Members& members : found) whole += volume_of(members);
  found = asked_for(std::move(found));
  network_of_.assign(spheres_.size(), kOutside);
  open_and_join(found, whole);
  if (plan_.network_count == 0) {
    throw NothingToRemoveError(
        "no place was found for two escape holes of " + shortened(2 * request_.hole_radius) +
            " mm, so no void can drain",
        request_.escape_holes.empty()
            ? "give a smaller --hole-diameter, larger voids, or places with --escape-hole"
            : "ask for other places, or leave --escape-hole out");
  }
  if (request_.escape_holes.size() < 2) open_pools(whole);
  if (pools_now().after_both > kPoolsAimedAt * whole) empty_pools();
  do {
    leave_out_pools();
  } while (regroup());
  if (plan_.holes.empty()) {
    throw NothingToRemoveError(
        "more than " + shortened(100 * kPoolsAimedAt) +
            " % of every group of voids would stay full, in print orientation and upside down",
        "give other places with --escape-hole, a smaller --hole-diameter, or larger voids");
  }
  return compacted();
}

// The voids that are kept so far, and the plan as it counts them.
PlannedDrainage Planner::compacted() const {
  PlannedDrainage result;
  result.plan = plan_;
  std::vector<std::uint32_t> renumbered(spheres_.size(), kOutside);
  for (std::uint32_t i = 0; i < spheres_.size(); ++i) {
    if (network_of_[i] == kOutside) continue;
    renumbered[i] = static_cast<std::uint32_t>(result.kept.size());
    result.kept.push_back(i);
  }
  for (Channel& c : result.plan.channels) {
    c.from = renumbered[c.from];
    c.to = renumbered[c.to];
  }
  std::map<std::uint32_t, std::uint32_t> networks;
  for (EscapeHole& hole : result.plan.holes) {
    hole.from = renumbered[hole.from];
    hole.network = networks.emplace(hole.network, static_cast<std::uint32_t>(networks.size())).first->second;
  }
  result.plan.network_count = networks.size();
  std::vector<Sphere> kept;
  for (const std::uint32_t i : result.kept) kept.push_back(spheres_[i]);
  result.plan.pools = trapped_pools(kept, result.plan);
  result.dropped = dropped_;
  return result;
}

}  // namespace

PlannedDrainage plan_drainage(const DrainableModel& model, const Packing& packing,
                              const DrainageRequest& request, const CanOpen& can_open, Monitor& monitor) {
  return Planner(model, packing, request, can_open, monitor).run();
}

}  // namespace aerate
