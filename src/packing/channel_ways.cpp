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
  std::vector<ChannelWay> from(std::uint32_t at, std::span<const std::uint32_t> neighbours) const {
    std::vector<ChannelWay> found;
    for (const std::uint32_t other : neighbours) {
      for (std::size_t way = 0; way < kWays && other > at; ++way) {
        const auto channel = find(at, other, way);
        if (channel) found.push_back({*channel, {sill_of(*channel, roof_.up), sill_of(*channel, -roof_.up)}});
      }
    }
    return found;
  }

 private:
  double sill_of(const Channel& channel, Vec3d up) const {
    return aerate::sill_of(channel.tube, voids_[channel.from], voids_[channel.to], up);
  }

  std::optional<Channel> find(std::uint32_t a, std::uint32_t b, std::size_t way) const {
    const Vec3d up = roof_.up;
    const double height_a = dot(voids_[a].centre(), up), height_b = dot(voids_[b].centre(), up);
    if (height_a > height_b || (height_a == height_b && a > b)) std::swap(a, b);
    const VoidShape& lower = voids_[a];
    const VoidShape& upper = voids_[b];
    if (way == kOutOfTop) return out_of_top(a, b);
    const Attachment where = kAttachments[way];
    Vec3d inside_lower = lower.centre() + up * (where.lower * lower.radius());
    const Vec3d inside_upper = upper.centre() + up * (where.upper * upper.radius());
    // Off the centres only where that leaves a channel which does not fall from the lower to the upper.
    if ((where.lower != 0 || where.upper != 0) && dot(inside_upper - inside_lower, up) < -kLevel)
      return std::nullopt;
    inside_lower = below_roof(lower, inside_lower, inside_upper);
    const auto tube = tube_between(lower, upper, inside_lower, inside_upper, radius_);
    if (!tube || length(tube->end - tube->start) > longest_ || !is_bridged(*tube, roof_) ||
        !lower.opens_below_roof(*tube, TubeEnd::start) || !upper.opens_below_roof(*tube, TubeEnd::end)) {
      return std::nullopt;
    }
    return Channel{a, b, *tube};
  }

  // Where a channel from a void with a roof to a higher place has to start so that it leaves the void below
  // the roof: `inside`, or so much beside it, across the channel and downwards.
  Vec3d below_roof(const VoidShape& shape, Vec3d inside, Vec3d to) const {
    if (!shape.has_roof()) return inside;
    for (int i = 0; i < kMostShifts; ++i) {
      const Vec3d along = to - inside;
      const auto way = shape.way_below_roof(along * (1 / length(along)), radius_);
      if (!way) return inside;
      const double excess = dot(inside - shape.centre(), way->across) - way->highest;
      if (excess <= 0) return inside;
      inside = inside - way->across * excess;
    }
    return inside;
  }

  std::optional<Channel> out_of_top(std::uint32_t lower, std::uint32_t upper) const {
    const VoidShape& from = voids_[lower];
    const VoidShape& to = voids_[upper];
    if (!from.has_top_for(radius_)) return std::nullopt;
    const auto tube =
        tube_into(to, from.centre() + roof_.up * from.top_opening_height(radius_), roof_.up, radius_);
    if (!tube || length(tube->end - tube->start) > longest_ || !to.opens_below_roof(*tube, TubeEnd::end))
      return std::nullopt;
    return Channel{lower, upper, *tube};
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
