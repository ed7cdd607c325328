#include "printing/cells/piece_roof.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <utility>

#include "core/disjoint_sets.h"
#include "core/upright.h"
#include "kernels/constants.h"

namespace aerate {
namespace {

constexpr int kSides = 8;

// How far a ceiling may lean beyond the overhang angle, degrees: what is measured has a margin of 5.
constexpr double kMarginDegrees = 2;

// Half of what a flat top may be wide, for centres of balls: the balls' own tops take the rest of the bridge.
double half_top(const Roof& roof, double ball_radius) {
  return std::max(0.0, roof.flat_radius() - ball_radius * roof.cosine);
}

// Where the balls' centres end beside a node, and which way.
struct Bound {
  Vec3d outward{0, 0, 0};
  double depth = kInfinity;
};

class CeilingFinder {
 public:
  CeilingFinder(const CellRegion& region, const CellNodes& nodes, const std::vector<std::int32_t>& labels,
                std::int32_t piece, const Roof& roof, double share)
      : region_(region),
        nodes_(nodes),
        labels_(labels),
        piece_(piece),
        roof_(roof),
        frame_(roof.up),
        widest_(2 * share * half_top(roof, nodes.ball_radius)) {}

  std::vector<FlatCeiling> find(SharedWork& work) {
    const NodeBox& box = nodes_.box;
    std::vector<std::vector<Found>> of_layer(static_cast<std::size_t>(box.count_z));
    work.for_each(of_layer.size(), 1, [&](std::size_t layer) {
      for (std::int32_t j = 0; j < box.count_y; ++j) {
        for (std::int32_t i = 0; i < box.count_x; ++i)
          look_at(i, j, static_cast<std::int32_t>(layer), of_layer[layer]);
      }
    });
    for (const std::vector<Found>& found : of_layer) found_.insert(found_.end(), found.begin(), found.end());
    return those_too_wide();
  }

 private:
  struct Found {
    std::size_t node;
    Vec3d at;
    Vec3d centre;  // of the ball that touches the ceiling
  };

  void look_at(std::int32_t i, std::int32_t j, std::int32_t k, std::vector<Found>& found) const {
    const std::size_t node = nodes_.box.index(i, j, k);
    if (labels_[node] != piece_ || !nodes_.is_outermost(node)) return;
    const Vec3d at = nodes_.box.at(i, j, k);
    const Bound bound = bound_at(node, at);
    const auto depth = static_cast<double>(nodes_.depth[node]);
    // Where something else than the region ends the piece, only nodes tell.
    if (bound.depth > depth + 0.01 * nodes_.box.lattice.spacing) {
      if (is_below_solid(at)) found.push_back({node, at, at});
      return;
    }
    const double least = std::sin(std::asin(roof_.sine) + kMarginDegrees * std::numbers::pi / 180);
    if (dot(bound.outward, roof_.up) > least)
      found.push_back({node, at, at + bound.outward * (bound.depth - nodes_.ball_radius)});
  }

  Bound bound_at(std::size_t node, Vec3d at) const {
    Bound nearest;
    for (const CellPlane& plane : region_.planes()) {
      const double depth = plane.offset - dot(plane.normal, at);
      if (depth < nearest.depth) nearest = {plane.normal, depth};
    }
    const std::uint32_t facet = nodes_.facet[node];
    if (facet == kNone) return nearest;
    const Vec3d way = region_.nearest_on(facet, at) - at;
    const double depth = length(way) - region_.wall();
    return depth < nearest.depth ? Bound{normalised(way), depth} : nearest;
  }

  // No ball's centre in the cone above that a ceiling which carries itself would leave open.
  bool is_below_solid(Vec3d at) const {
    constexpr double kLayers = 2;
    const double rise = kLayers * nodes_.box.lattice.spacing;
    const double aside = rise * roof_.sine / roof_.cosine;
    if (has_ball_at(at + roof_.up * rise)) return false;
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2 * std::numbers::pi * side / kSides;
      const Vec3d way = frame_.x * std::cos(angle) + frame_.y * std::sin(angle);
      if (has_ball_at(at + roof_.up * rise + way * aside)) return false;
    }
    return true;
  }

  bool has_ball_at(Vec3d p) const {
    const auto nearest = nodes_.box.nearest(p);
    if (!nearest) return false;
    const auto [i, j, k] = *nearest;
    const std::size_t node = nodes_.box.index(i, j, k);
    return labels_[node] == piece_ && nodes_.has_ball(node);
  }

  // Found places that are beside each other are one ceiling.
  std::vector<FlatCeiling> those_too_wide() const {
    const NodeBox& box = nodes_.box;
    DisjointSets sets(found_.size());
    const auto number = [&](std::size_t node) {
      const auto at = std::ranges::lower_bound(found_, node, {}, &Found::node);
      return at != found_.end() && at->node == node ? static_cast<std::size_t>(at - found_.begin())
                                                    : found_.size();
    };
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const std::size_t node = found_[i].node;
      for (const std::size_t layer : {node, node + box.step_z()}) {
        for (const std::size_t row : {layer - box.step_y(), layer, layer + box.step_y()}) {
          for (const std::size_t next : {row - 1, row, row + 1}) {
            const std::size_t other = next > node ? number(next) : found_.size();
            if (other < found_.size())
              sets.join(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(other));
          }
        }
      }
    }
    std::map<std::uint32_t, std::vector<Vec3d>> ceilings;
    for (std::uint32_t i = 0; i < found_.size(); ++i)
      ceilings[sets.root(i)].push_back(frame_.to_frame(found_[i].at));
    std::map<std::uint32_t, bool> is_too_wide;
    for (const auto& [root, places] : ceilings) is_too_wide[root] = widest_disc(places) > widest_;
    std::vector<FlatCeiling> result;
    for (std::uint32_t i = 0; i < found_.size(); ++i)
      if (is_too_wide[sets.root(i)]) result.push_back({found_[i].centre});
    return result;
  }

  // Of those that fit into squares of a grid, seen from above, that places are in, less one square.
  double widest_disc(const std::vector<Vec3d>& places) const {
    // So that nodes beside each other leave no square between them.
    const double side =
        nodes_.box.lattice.spacing * (std::abs(roof_.up.x) + std::abs(roof_.up.y) + std::abs(roof_.up.z));
    double x0 = kInfinity, y0 = kInfinity, x1 = -kInfinity, y1 = -kInfinity;
    for (const Vec3d p : places) {
      x0 = std::min(x0, p.x), x1 = std::max(x1, p.x);
      y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
    }
    const auto columns = static_cast<std::size_t>((x1 - x0) / side) + 4;
    const auto rows = static_cast<std::size_t>((y1 - y0) / side) + 4;
    // Of each square how many squares around it are in the ceiling too.
    std::vector<std::uint16_t> rings(columns * rows, 0);
    for (const Vec3d p : places) {
      const auto column = static_cast<std::size_t>(std::lround((p.x - x0) / side)) + 1;
      const auto row = static_cast<std::size_t>(std::lround((p.y - y0) / side)) + 1;
      rings[row * columns + column] = 1;
    }
    std::uint16_t most = 0;
    const auto at = [&](std::size_t row, std::size_t column) { return rings[row * columns + column]; };
    for (std::size_t row = 1; row + 1 < rows; ++row) {
      for (std::size_t column = 1; column + 1 < columns; ++column) {
        if (at(row, column) == 0) continue;
        const auto least = std::min({at(row - 1, column - 1), at(row - 1, column), at(row, column - 1)});
        rings[row * columns + column] = static_cast<std::uint16_t>(least + 1);
        most = std::max(most, rings[row * columns + column]);
      }
    }
    return (most - 1) * side;
  }

  const CellRegion& region_;
  const CellNodes& nodes_;
  const std::vector<std::int32_t>& labels_;
  std::int32_t piece_;
  const Roof& roof_;
  UprightFrame frame_;
  double widest_;             // disc in a ceiling that is left, mm
  std::vector<Found> found_;  // ascending by node
};

// In the frame of the roof. A point is below side i if dot(side, p) <= offset[i], where `side` has length 1 seen
// from above and rises by the tangent of the overhang angle.
struct Tent {
  std::array<double, kSides> offset{};
  double top = kInfinity;
};

class TentFinder {
 public:
  TentFinder(std::span<const FlatCeiling> ceilings, const CellNodes& nodes,
             const std::vector<std::int32_t>& labels, std::int32_t piece, const Roof& roof)
      : roof_(roof),
        frame_(roof.up),
        tangent_(roof.sine / roof.cosine),
        half_top_(half_top(roof, nodes.ball_radius)),
        ball_radius_(nodes.ball_radius) {
    for (int i = 0; i < kSides; ++i) {
      const double angle = 2 * std::numbers::pi * i / kSides;
      sides_[static_cast<std::size_t>(i)] = {std::cos(angle), std::sin(angle), tangent_};
    }
    for (const FlatCeiling& ceiling : ceilings) ceilings_.push_back(frame_.to_frame(ceiling.centre));
    sample(nodes, labels, piece);
  }

  std::vector<CellPlane> find() const {
    Found best;
    for (const auto& [held, under] : best_places()) {
      for (int kept = 0; kept < kSides / 2; ++kept) best = better(best, under, kept);
    }
    if (best.count == 0) return {};
    // Between the places that were looked at.
    constexpr int kHalvings = 4;
    double step = place_step() / 2;
    for (int i = 0; i < kHalvings; ++i, step /= 2) {
      const Found from = best;
      for (const auto& [x, y] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const double to_x = from.under.x + x * step, to_y = from.under.y + y * step;
        best = better(best, {to_x, to_y, top_at(to_x, to_y)}, from.kept);
      }
    }
    return planes_of(best.tent);
  }

 private:
  struct Found {
    Tent tent;
    Vec3d under{0, 0, 0};
    int kept = 0;
    std::size_t count = 0;  // of samples in it
  };

  Found better(const Found& known, Vec3d under, int kept) const {
    const Tent tent = widened(tent_under(under), kept);
    const std::size_t count = count_in(tent);
    return count > known.count ? Found{tent, under, kept, count} : known;
  }

  // Some of the balls' centres, evenly.
  void sample(const CellNodes& nodes, const std::vector<std::int32_t>& labels, std::int32_t piece) {
    constexpr std::size_t kMost = 4000;
    const NodeBox& box = nodes.box;
    const auto is_in = [&](std::size_t node) { return labels[node] == piece && nodes.has_ball(node); };
    std::size_t count = 0;
    for (std::size_t node = 0; node < box.size(); ++node) count += is_in(node) ? 1U : 0U;
    std::int32_t step = 1;
    while (count / static_cast<std::size_t>(step * step * step) > kMost) ++step;
    // The same ones in whatever part of the box.
    const auto first = [step](std::int32_t cut) { return (step - cut % step) % step; };
    for (std::int32_t k = first(box.cut_z); k < box.count_z; k += step) {
      for (std::int32_t j = first(box.cut_y); j < box.count_y; j += step) {
        for (std::int32_t i = first(box.cut_x); i < box.count_x; i += step)
          if (is_in(box.index(i, j, k))) samples_.push_back(frame_.to_frame(box.at(i, j, k)));
      }
    }
    for (const Vec3d p : samples_) {
      lowest_ = min_of(lowest_, p);
      highest_ = max_of(highest_, p);
    }
  }

  // How high the top of a roof may be at a place seen from above.
  double top_at(double x, double y) const {
    double top = highest_.z;
    for (const Vec3d& f : ceilings_) {
      if (f.z >= top) continue;
      double aside = 0;
      for (const Vec3d& side : sides_) aside = std::max(aside, side.x * (f.x - x) + side.y * (f.y - y));
      top = std::min(top, f.z + std::max(0.0, aside - half_top_) / tangent_);
    }
    return top;
  }

  // Places that are looked at along one side.
  static constexpr int kAcross = 14;

  double place_step() const { return std::max(highest_.x - lowest_.x, highest_.y - lowest_.y) / kAcross; }

  // By how many samples the roofs there hold, the most first.
  std::vector<std::pair<std::size_t, Vec3d>> best_places() const {
    constexpr std::size_t kTaken = 12;
    std::vector<std::pair<std::size_t, Vec3d>> places;
    for (int row = 0; row < kAcross; ++row) {
      for (int column = 0; column < kAcross; ++column) {
        const double x = lowest_.x + (highest_.x - lowest_.x) * (column + 0.5) / kAcross;
        const double y = lowest_.y + (highest_.y - lowest_.y) * (row + 0.5) / kAcross;
        const Vec3d under{x, y, top_at(x, y)};
        const std::size_t held = count_in(tent_under(under));
        if (held > 0) places.emplace_back(held, under);
      }
    }
    std::ranges::stable_sort(places, [](const auto& a, const auto& b) { return a.first > b.first; });
    if (places.size() > kTaken) places.resize(kTaken);
    return places;
  }

  Tent tent_under(Vec3d under) const {
    Tent tent{.top = under.z};
    for (std::size_t i = 0; i < kSides; ++i) tent.offset[i] = dot(sides_[i], under) + half_top_;
    return tent;
  }

  // With all sides moved out as far as the ceilings allow, but two that face each other: the top gets no wider.
  Tent widened(Tent tent, int kept) const {
    constexpr int kHalf = kSides / 2, kQuarter = kSides / 4;
    for (const int turn : {kQuarter, kQuarter + kHalf, 1, 1 + kHalf, kSides - 1, kHalf - 1}) {
      const auto moved = static_cast<std::size_t>((kept + turn) % kSides);
      double offset = kInfinity;
      for (const Vec3d& f : ceilings_) {
        if (f.z < tent.top && !is_outside(f, tent, moved)) offset = std::min(offset, dot(sides_[moved], f));
      }
      tent.offset[moved] = offset;
    }
    return tent;
  }

  // Of a side other than this one.
  bool is_outside(const Vec3d& p, const Tent& tent, std::size_t other) const {
    constexpr double kRounding = 1e-9;
    for (std::size_t i = 0; i < kSides; ++i)
      if (i != other && dot(sides_[i], p) >= tent.offset[i] - kRounding) return true;
    return false;
  }

  std::size_t count_in(const Tent& tent) const {
    std::size_t count = 0;
    for (const Vec3d& p : samples_) {
      bool is_in = p.z <= tent.top;
      for (std::size_t i = 0; is_in && i < kSides; ++i) is_in = dot(sides_[i], p) <= tent.offset[i];
      count += is_in ? 1U : 0U;
    }
    return count;
  }

  std::vector<CellPlane> planes_of(const Tent& tent) const {
    std::vector<CellPlane> planes;
    const auto add = [&](Vec3d in_frame, double offset) {
      const Vec3d normal = frame_.x * in_frame.x + frame_.y * in_frame.y + frame_.z * in_frame.z;
      planes.push_back({normal, offset + ball_radius_, kNone});
    };
    for (std::size_t i = 0; i < kSides; ++i)
      if (tent.offset[i] < kInfinity) add(sides_[i] * roof_.cosine, tent.offset[i] * roof_.cosine);
    add({0, 0, 1}, tent.top);
    return planes;
  }

  const Roof& roof_;
  UprightFrame frame_;
  double tangent_, half_top_, ball_radius_;
  std::array<Vec3d, kSides> sides_;
  std::vector<Vec3d> ceilings_, samples_;  // in the frame
  Vec3d lowest_{kInfinity, kInfinity, kInfinity}, highest_{-kInfinity, -kInfinity, -kInfinity};  // of samples
};

}  // namespace

std::vector<FlatCeiling> flat_ceilings(const CellRegion& region, const CellNodes& nodes,
                                       const std::vector<std::int32_t>& labels, std::int32_t piece,
                                       const Roof& roof, double share, SharedWork& work) {
  return CeilingFinder(region, nodes, labels, piece, roof, share).find(work);
}

std::vector<CellPlane> roof_below(std::span<const FlatCeiling> ceilings, const CellNodes& nodes,
                                  const std::vector<std::int32_t>& labels, std::int32_t piece,
                                  const Roof& roof) {
  return TentFinder(ceilings, nodes, labels, piece, roof).find();
}

}  // namespace aerate
