#include "packing/channel_ways.h"

#include <algorithm>
#include <array>
#include <tbb/parallel_for.h>
#include <utility>

#include "packing/pools.h"
#include "packing/tube_through.h"

namespace aerate {
namespace {

// Where the axis of a channel passes the voids that it joins: so many radii above the centre of the lower
// one, and below that of the upper.
struct Attachment {
  double lower, upper;
};
constexpr std::array<Attachment, 7> kAttachments{
    {{0.7, -0.7}, {0.35, -0.35}, {0, 0}, {0, -0.7}, {0.7, 0}, {-0.35, -0.7}, {-0.7, -0.7}}};

// After those: straight up out of the top of a roof.
constexpr std::size_t kOutOfTop = kAttachments.size();
constexpr std::size_t kWays = kOutOfTop + 1;

// A channel that falls by less is level, mm.
constexpr double kLevel = 1e-6;

// Channels that leave below a roof are moved so many times at most, since that turns them.
constexpr int kMostShifts = 4;

// Voids that are looked at between questions to the monitor.
constexpr std::size_t kVoidsPerPiece = 256;

class ChannelFinder {
 public:
  ChannelFinder(std::span<const VoidShape> voids, const Roof& roof, double radius, double longest)
      : voids_(voids), roof_(roof), radius_(radius), longest_(longest) {}

  // All from a void to others that come after it.
  std::vector<ChannelWay> from(std::uint32_t at, std::span<const TubeClearance::Neighbour> neighbours) const {
    std::vector<ChannelWay> found;
    for (const auto& [gap, other] : neighbours) {
      if (other < at) continue;
      const auto height_of = [&](std::uint32_t i) { return dot(voids_[i].centre(), roof_.up); };
      const bool is_lower = height_of(at) <= height_of(other);
      const std::uint32_t a = is_lower ? at : other, b = is_lower ? other : at;
      const VoidShape& lower = voids_[a];
      const VoidShape& upper = voids_[b];
      for (std::size_t way = 0; way < kWays; ++way) {
        const auto tube =
            way == kOutOfTop ? out_of_top(lower, upper) : through(lower, upper, kAttachments[way]);
        if (!tube || length(tube->end - tube->start) > longest_ || !is_bridged(*tube, roof_) ||
            !lower.may_open(*tube, TubeEnd::start) || !upper.may_open(*tube, TubeEnd::end))
          continue;
        found.push_back({{a, b, *tube},
                         {sill_of(*tube, lower, upper, roof_.up), sill_of(*tube, lower, upper, -roof_.up)}});
      }
    }
    return found;
  }

 private:
  std::optional<Tube> through(const VoidShape& lower, const VoidShape& upper, Attachment where) const {
    const Vec3d inside_lower = lower.centre() + roof_.up * (where.lower * lower.radius());
    const Vec3d inside_upper = upper.centre() + roof_.up * (where.upper * upper.radius());
    // Off the centres only where that leaves a channel which does not fall from the lower to the upper.
    if ((where.lower != 0 || where.upper != 0) && dot(inside_upper - inside_lower, roof_.up) < -kLevel)
      return std::nullopt;
    return tube_between(lower, upper, below_roof(lower, inside_lower, inside_upper), inside_upper, radius_);
  }

  std::optional<Tube> out_of_top(const VoidShape& lower, const VoidShape& upper) const {
    if (!lower.has_top_for(radius_)) return std::nullopt;
    const Vec3d start = lower.centre() + roof_.up * lower.top_opening_height(radius_);
    return tube_into(upper, start, roof_.up, radius_);
  }

  // Where a channel from a void with a roof to a higher place has to start so that it leaves the void below
  // the roof: `inside`, or so much beside it, across the channel and downwards.
  Vec3d below_roof(const VoidShape& shape, Vec3d inside, Vec3d to) const {
    if (!shape.has_roof()) return inside;
    for (int i = 0; i < kMostShifts; ++i) {
      const Vec3d along = to - inside;
      const auto way = shape.way_below_roof(normalised(along), radius_);
      if (!way) return inside;
      const double excess = dot(inside - shape.centre(), way->across) - way->highest;
      if (excess <= 0) return inside;
      inside = inside - way->across * excess;
    }
    return inside;
  }

  std::span<const VoidShape> voids_;
  const Roof& roof_;
  double radius_;
  double longest_;
};

}  // namespace

ChannelWays::ChannelWays(std::span<const VoidShape> voids, const Roof& roof, double radius, double longest,
                         const TubeClearance& clearance, Monitor& monitor)
    : clearance_(clearance), of_void_(voids.size()) {
  const ChannelFinder finder(voids, roof, radius, longest);
  std::vector<std::vector<ChannelWay>> of_piece(kVoidsPerPiece);
  for (std::size_t first = 0; first < voids.size(); first += kVoidsPerPiece) {
    monitor.check_interrupted();
    const std::size_t count = std::min(kVoidsPerPiece, voids.size() - first);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      const auto at = static_cast<std::uint32_t>(first + i);
      of_piece[i] = finder.from(at, clearance.neighbours(at));
    });
    for (std::size_t i = 0; i < count; ++i) ways_.insert(ways_.end(), of_piece[i].begin(), of_piece[i].end());
  }
  for (std::uint32_t way = 0; way < ways_.size(); ++way) {
    of_void_[ways_[way].channel.from].push_back(way);
    of_void_[ways_[way].channel.to].push_back(way);
  }
  free_.resize(ways_.size());
}

bool ChannelWays::is_free(std::size_t way) {
  if (!free_[way]) {
    const Channel& channel = ways_[way].channel;
    free_[way] = clearance_.keeps_gap_to_voids(channel.tube, channel.from, channel.to) &&
                 clearance_.keeps_wall(channel.tube);
  }
  return *free_[way];
}

}  // namespace aerate
