#include "packing/air/found_hollows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tbb/parallel_for.h>
#include <utility>

#include "core/packing.h"
#include "kernels/constants.h"
#include "kernels/nearest_point.h"
#include "packing/tube_clearance.h"

namespace aerate {
namespace {

// A pocket of fewer nodes is the lattice's own.
constexpr std::size_t kLeastNodes = 8;

// Air is wider inside than where it opens if it holds a ball this much wider.
constexpr double kWiderInside = 1.2;

// It is deep behind its openings if it holds so much more than a cube on their area.
constexpr double kDeepBehind = 8;

struct Pocket {
  std::vector<std::size_t> nodes;
  std::size_t contacts = 0;      // with the outside, in squares of the lattice
  std::size_t deepest = 0;       // node
  double widest = 0;             // clearance of that
  double widest_at_opening = 0;  // of the nodes that touch the outside
};

std::vector<Pocket> pockets_of(const AirColumns& columns, const AirNodes& nodes,
                               std::vector<std::uint32_t>& pocket_of) {
  const AirNeighbours neighbours(columns, nodes);
  std::vector<Pocket> pockets;
  pocket_of.assign(nodes.span.size(), kNone);
  for (std::size_t start = 0; start < nodes.span.size(); ++start) {
    if (nodes.span[start] == kNone || nodes.is_outside[start] != 0 || pocket_of[start] != kNone) continue;
    const auto number = static_cast<std::uint32_t>(pockets.size());
    Pocket& pocket = pockets.emplace_back();
    pocket.nodes.push_back(start);
    pocket_of[start] = number;
    for (std::size_t i = 0; i < pocket.nodes.size(); ++i) {
      const std::size_t at = pocket.nodes[i];
      const auto clearance = static_cast<double>(nodes.clearance[at]);
      if (clearance > pocket.widest) {
        pocket.widest = clearance;
        pocket.deepest = at;
      }
      neighbours.for_each(at, [&](std::size_t next, int, int) {
        if (nodes.is_outside[next] != 0) {
          ++pocket.contacts;
          pocket.widest_at_opening = std::max(pocket.widest_at_opening, clearance);
        } else if (pocket_of[next] == kNone) {
          pocket_of[next] = number;
          pocket.nodes.push_back(next);
        }
      });
    }
  }
  return pockets;
}

bool is_hollow(const Pocket& pocket, bool is_sealed, double spacing, double widest_hole) {
  if (pocket.nodes.size() < kLeastNodes || pocket.widest < 0.75 * spacing) return false;
  // It opens where the lattice cannot follow: by a crack, unless much is behind it.
  const double least_behind_crack = widest_hole * widest_hole * widest_hole / (spacing * spacing * spacing);
  if (pocket.contacts == 0 && !is_sealed)
    return static_cast<double>(pocket.nodes.size()) > least_behind_crack;
  if (pocket.widest >= kWiderInside * pocket.widest_at_opening) return true;
  // In spacings.
  const auto area = static_cast<double>(pocket.contacts);
  return static_cast<double>(pocket.nodes.size()) > kDeepBehind * area * std::sqrt(area);
}

// The hollows' pockets, the largest first.
std::vector<std::uint32_t> hollow_pockets(const std::vector<Pocket>& pockets, const AirNodes& nodes,
                                          const AirFlood& drained, double spacing, double widest_hole) {
  std::vector<std::uint32_t> hollow;
  for (std::uint32_t i = 0; i < pockets.size(); ++i) {
    const bool is_sealed = drained.height[nodes.span[pockets[i].nodes.front()]] == kInfinity;
    if (is_hollow(pockets[i], is_sealed, spacing, widest_hole)) hollow.push_back(i);
  }
  std::stable_sort(hollow.begin(), hollow.end(), [&](std::uint32_t a, std::uint32_t b) {
    return pockets[a].nodes.size() > pockets[b].nodes.size();
  });
  return hollow;
}

class HoleFinder {
 public:
  HoleFinder(const AirColumns& columns, const AirNodes& nodes, const SurfaceIndex& surface)
      : columns_(columns), nodes_(nodes), surface_(surface), neighbours_(columns, nodes) {}

  // Sets of its nodes beside the outside that touch each other are holes.
  std::vector<FoundHole> holes_of(const Pocket& pocket, std::uint32_t hollow) const {
    std::vector<std::size_t> beside;
    for (const std::size_t node : pocket.nodes) {
      bool touches = false;
      neighbours_.for_each(node,
                           [&](std::size_t next, int, int) { touches |= nodes_.is_outside[next] != 0; });
      if (touches) beside.push_back(node);
    }
    std::sort(beside.begin(), beside.end());
    std::vector<char> is_taken(beside.size(), 0);
    std::vector<FoundHole> holes;
    for (std::size_t i = 0; i < beside.size(); ++i) {
      if (is_taken[i] != 0) continue;
      const FoundHole hole = hole_at(cluster_from(i, beside, is_taken), hollow);
      if (hole.width >= columns_.spacing) holes.push_back(hole);
    }
    std::stable_sort(holes.begin(), holes.end(),
                     [](const FoundHole& a, const FoundHole& b) { return a.width > b.width; });
    return holes;
  }

  Vec3d place_of(std::size_t node) const {
    return columns_.at(nodes_.span[node],
                       nodes_.height(static_cast<std::uint32_t>(node % nodes_.count_z), columns_.spacing));
  }

 private:
  std::vector<std::size_t> cluster_from(std::size_t first, const std::vector<std::size_t>& beside,
                                        std::vector<char>& is_taken) const {
    std::vector<std::size_t> cluster{first};
    is_taken[first] = 1;
    for (std::size_t k = 0; k < cluster.size(); ++k) {
      const std::size_t at = beside[cluster[k]];
      for (int step = 0; step < 27; ++step) {
        const std::ptrdiff_t along_z = step % 3 - 1, along_x = step / 3 % 3 - 1, along_y = step / 9 - 1;
        const auto layers = static_cast<std::ptrdiff_t>(nodes_.count_z);
        const std::ptrdiff_t next =
            static_cast<std::ptrdiff_t>(at) + along_z +
            layers * (along_x + along_y * static_cast<std::ptrdiff_t>(columns_.count_x));
        const auto found = std::lower_bound(beside.begin(), beside.end(), static_cast<std::size_t>(next));
        if (found == beside.end() || *found != static_cast<std::size_t>(next)) continue;
        const auto i = static_cast<std::size_t>(found - beside.begin());
        if (is_taken[i] == 0) cluster.push_back(i);
        is_taken[i] = 1;
      }
    }
    for (std::size_t& i : cluster) i = beside[i];
    return cluster;
  }

  FoundHole hole_at(const std::vector<std::size_t>& cluster, std::uint32_t hollow) const {
    const std::size_t widest = *std::max_element(
        cluster.begin(), cluster.end(),
        [&](std::size_t a, std::size_t b) { return nodes_.clearance[a] < nodes_.clearance[b]; });
    Vec3d outwards{0, 0, 0};
    for (const std::size_t node : cluster) {
      neighbours_.for_each(node, [&](std::size_t next, int axis, int side) {
        if (nodes_.is_outside[next] == 0) return;
        (axis == 0 ? outwards.x : axis == 1 ? outwards.y : outwards.z) += side;
      });
    }
    const Vec3d place = narrowest_inwards(place_of(widest), outwards);
    return {place, 2 * clearance_at(place), hollow};
  }

  // The outside reaches some way in where a hole widens towards it: the narrowest place is at most so far inside.
  Vec3d narrowest_inwards(Vec3d place, Vec3d outwards) const {
    constexpr int kHalfSpacings = 6;
    if (length(outwards) == 0) return place;
    const Vec3d axis = normalised(outwards);
    Vec3d at = middle_near(place, axis), narrowest = at;
    for (int i = 0; i < kHalfSpacings; ++i) {
      at = at - axis * (columns_.spacing / 2);
      if (surface_.winding().winding_number(at) > 0) break;
      at = middle_near(at, axis);
      if (clearance_at(at) < clearance_at(narrowest)) narrowest = at;
    }
    return narrowest;
  }

  double clearance_at(Vec3d p) const {
    return std::sqrt(surface_.bvh().nearest(p, kInfinity).distance_squared);
  }

  // Where in a plane across the hole it is clearest: nodes lie beside its axis.
  Vec3d middle_near(Vec3d place, Vec3d axis) const {
    const Vec3d aside = std::abs(axis.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d u = normalised(cross(axis, aside)), v = cross(axis, u);
    const Vec3d node = place;
    double best = clearance_at(place);
    for (double step = columns_.spacing / 2; step > columns_.spacing / 40;) {
      bool is_better = false;
      for (const Vec3d way : {u, -u, v, -v}) {
        const double clearance = clearance_at(place + way * step);
        if (clearance <= best || length(place + way * step - node) > columns_.spacing) continue;
        best = clearance;
        place = place + way * step;
        is_better = true;
        break;
      }
      if (!is_better) step /= 2;
    }
    return place;
  }

  const AirColumns& columns_;
  const AirNodes& nodes_;
  const SurfaceIndex& surface_;
  AirNeighbours neighbours_;
};

// What of each span belongs to hollows, and to which.
struct HollowSpans {
  std::vector<AirPart> parts;
  std::vector<std::uint32_t> hollow_of;
};

class SpanSorter {
 public:
  SpanSorter(const AirColumns& columns, const AirNodes& nodes, const std::vector<Pocket>& pockets,
             const std::vector<std::uint32_t>& pocket_of, const std::vector<std::uint32_t>& hollow_of_pocket)
      : columns_(columns), nodes_(nodes) {
    spans_.parts.resize(columns.spans.size());
    spans_.hollow_of.assign(columns.spans.size(), kNone);
    is_elsewhere_.assign(columns.spans.size(), 0);
    for (std::size_t node = 0; node < nodes.span.size(); ++node) {
      const std::uint32_t span = nodes.span[node];
      if (span == kNone) continue;
      const std::uint32_t pocket = pocket_of[node];
      if (pocket != kNone && hollow_of_pocket[pocket] != kNone)
        add(span, node, hollow_of_pocket[pocket]);
      else if (pocket == kNone || pockets[pocket].nodes.size() >= kLeastNodes)
        is_elsewhere_[span] = 1;
    }
  }

  // Spans between nodes belong to the hollow beside them.
  HollowSpans take() {
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = 0; i < spans_.parts.size(); ++i) {
      if (spans_.hollow_of[i] != kNone) open.push_back(i);
    }
    for (std::size_t k = 0; k < open.size(); ++k) {
      const std::uint32_t from = open[k];
      for (const AirPassage& passage : columns_.passages_of(from)) {
        const AirSpan& span = columns_.spans[passage.to];
        const bool is_free = spans_.hollow_of[passage.to] == kNone && is_elsewhere_[passage.to] == 0 &&
                             span.floor > -kInfinity && span.ceiling < kInfinity;
        if (!is_free || passage.highest < spans_.parts[from].from || passage.lowest > spans_.parts[from].to)
          continue;
        spans_.hollow_of[passage.to] = spans_.hollow_of[from];
        spans_.parts[passage.to] = {span.floor, span.ceiling};
        open.push_back(passage.to);
      }
    }
    return std::move(spans_);
  }

 private:
  // Nodes of a span come from the lowest up.
  void add(std::uint32_t span, std::size_t node, std::uint32_t hollow) {
    const std::size_t layer = node % nodes_.count_z;
    const double height = nodes_.height(static_cast<std::uint32_t>(layer), columns_.spacing);
    const bool is_first = layer == 0 || nodes_.span[node - 1] != span;
    const bool is_last = layer + 1 == nodes_.count_z || nodes_.span[node + 1] != span;
    const double half = columns_.spacing / 2;
    const AirSpan& whole = columns_.spans[span];
    AirPart& part = spans_.parts[span];
    if (spans_.hollow_of[span] == kNone) part.from = is_first ? whole.floor : height - half;
    spans_.hollow_of[span] = hollow;
    part.to = is_last ? whole.ceiling : height + half;
  }

  const AirColumns& columns_;
  const AirNodes& nodes_;
  HollowSpans spans_;
  std::vector<char> is_elsewhere_;
};

class WallFinder {
 public:
  WallFinder(const AirColumns& columns, const AirNodes& nodes, const SurfaceIndex& surface)
      : columns_(columns),
        nodes_(nodes),
        surface_(surface),
        longest_(length(surface.winding().box.upper - surface.winding().box.lower)),
        rays_(surface, Packing{}, longest_, 0) {}

  // From a place in a hollow over the nearest point of its surface straight on: how thick what is there is, if the
  // outside is behind it.
  std::optional<ThinWall> beyond(Vec3d inside) const {
    const kernels::NearestFacet nearest = surface_.bvh().nearest(inside, kInfinity);
    const Vec3d on_wall = kernels::nearest_point_on_facet(inside, surface_.bvh().facets[nearest.facet]).point;
    const Vec3d way = on_wall - inside;
    if (!(length(way) > 1e-6)) return std::nullopt;
    const Vec3d direction = normalised(way);
    constexpr double kPastSurface = 1e-4;
    const auto hit = rays_.first_hit(on_wall + direction * kPastSurface, direction, longest_);
    if (!hit) return std::nullopt;
    const double thickness = *hit + kPastSurface;
    if (!is_outside_at(on_wall + direction * (thickness + columns_.spacing / 2))) return std::nullopt;
    return ThinWall{thickness, on_wall};
  }

 private:
  bool is_outside_at(Vec3d p) const {
    const auto down = [&](double along) {
      return static_cast<std::ptrdiff_t>(std::floor(along / columns_.spacing));
    };
    const std::ptrdiff_t x = down(p.x - columns_.origin_x), y = down(p.y - columns_.origin_y),
                         z = down(p.z - nodes_.origin_z);
    for (std::ptrdiff_t corner = 0; corner < 8; ++corner) {
      const std::ptrdiff_t i = x + corner % 2, j = y + corner / 2 % 2, k = z + corner / 4;
      const bool is_there = i >= 0 && j >= 0 && k >= 0 && i < static_cast<std::ptrdiff_t>(columns_.count_x) &&
                            j < static_cast<std::ptrdiff_t>(columns_.count_y) &&
                            k < static_cast<std::ptrdiff_t>(nodes_.count_z);
      if (!is_there) continue;
      const std::size_t column =
          columns_.column(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j));
      if (nodes_.is_outside[column * nodes_.count_z + static_cast<std::size_t>(k)] != 0) return true;
    }
    return false;
  }

  const AirColumns& columns_;
  const AirNodes& nodes_;
  const SurfaceIndex& surface_;
  double longest_;
  TubeClearance rays_;
};

// As far from a hole as one and a half of its widths its rim may be near, however it lies.
bool is_at_hole(Vec3d p, const std::vector<FoundHole>& holes) {
  return std::ranges::any_of(
      holes, [&](const FoundHole& hole) { return length(p - hole.place) < 1.5 * hole.width; });
}

std::optional<ThinWall> thinnest_wall(const WallFinder& finder, const HoleFinder& places,
                                      const std::vector<FoundHole>& holes,
                                      const std::vector<std::size_t>& at_walls) {
  std::vector<std::optional<ThinWall>> walls(at_walls.size());
  tbb::parallel_for(std::size_t{0}, at_walls.size(), [&](std::size_t i) {
    const Vec3d place = places.place_of(at_walls[i]);
    if (!is_at_hole(place, holes)) walls[i] = finder.beyond(place);
  });
  std::optional<ThinWall> thinnest;
  for (const auto& wall : walls) {
    if (wall && (!thinnest || wall->thickness < thinnest->thickness)) thinnest = wall;
  }
  return thinnest;
}

// Nodes beside the hollow's walls, thinned evenly where there are many.
std::vector<std::size_t> nodes_at_walls(const Pocket& pocket, const AirNodes& nodes, double spacing) {
  constexpr std::size_t kMost = 100000;
  std::vector<std::size_t> near;
  for (const std::size_t node : pocket.nodes) {
    if (static_cast<double>(nodes.clearance[node]) < spacing) near.push_back(node);
  }
  const std::size_t step = near.size() / kMost + 1;
  std::vector<std::size_t> some;
  for (std::size_t i = 0; i < near.size(); i += step) some.push_back(near[i]);
  return some;
}

}  // namespace

FoundHollows find_hollows(const AirColumns& columns, const AirNodes& nodes, const SurfaceIndex& surface,
                          const AirFlood& drained, double widest_hole) {
  std::vector<std::uint32_t> pocket_of;
  const std::vector<Pocket> pockets = pockets_of(columns, nodes, pocket_of);
  const std::vector<std::uint32_t> hollow_of =
      hollow_pockets(pockets, nodes, drained, columns.spacing, widest_hole);
  std::vector<std::uint32_t> hollow_of_pocket(pockets.size(), kNone);
  for (std::uint32_t i = 0; i < hollow_of.size(); ++i) hollow_of_pocket[hollow_of[i]] = i;
  HollowSpans spans = SpanSorter(columns, nodes, pockets, pocket_of, hollow_of_pocket).take();

  const HoleFinder finder(columns, nodes, surface);
  const WallFinder walls(columns, nodes, surface);
  FoundHollows found;
  for (std::uint32_t i = 0; i < hollow_of.size(); ++i) {
    const Pocket& pocket = pockets[hollow_of[i]];
    const bool is_sealed = drained.height[nodes.span[pocket.deepest]] == kInfinity;
    found.hollows.push_back({0, finder.place_of(pocket.deepest), is_sealed});
    const std::vector<FoundHole> holes = finder.holes_of(pocket, i);
    found.holes.insert(found.holes.end(), holes.begin(), holes.end());
    const auto wall = thinnest_wall(walls, finder, holes, nodes_at_walls(pocket, nodes, columns.spacing));
    if (wall && (!found.wall || wall->thickness < found.wall->thickness)) found.wall = wall;
  }
  for (std::size_t i = 0; i < spans.parts.size(); ++i) {
    if (spans.hollow_of[i] == kNone) continue;
    found.hollows[spans.hollow_of[i]].volume += columns.area() * (spans.parts[i].to - spans.parts[i].from);
  }
  found.parts = std::move(spans.parts);
  return found;
}

}  // namespace aerate
