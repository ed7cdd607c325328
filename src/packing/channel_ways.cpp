#include "packing/channel_ways.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/top_opening.h"
#include "packing/tube_through.h"

namespace aerate {
namespace {

// Where the axis of a channel passes the balls that it joins: so many radii above the centre of the lower
// one, and below that of the upper.
struct Attachment {
  double lower, upper;
};
constexpr std::array<Attachment, 7> kAttachments{
    {{0.7, -0.7}, {0.35, -0.35}, {0, 0}, {0, -0.7}, {0.7, 0}, {-0.35, -0.7}, {-0.7, -0.7}}};

// After those: straight up out of the top of a roof.
constexpr std::size_t kOutOfTop = kAttachments.size();
static_assert(ChannelWays::kCount == kAttachments.size() + 1);

// A channel that falls by less is level, mm.
constexpr double kLevel = 1e-6;

// Channels that leave below a roof are moved so many times at most, since that turns them.
constexpr int kMostShifts = 4;

}  // namespace

ChannelWays::ChannelWays(std::span<const Sphere> spheres, const Roof& roof, double radius, double longest,
                         const TubeClearance& clearance)
    : spheres_(spheres), roof_(roof), radius_(radius), longest_(longest), clearance_(clearance) {}

// Where a channel from a ball with a roof to a higher place has to start so that it leaves the ball below the
// roof: `inside`, or so much beside it, across the channel and downwards.
Vec3d ChannelWays::below_roof(const Sphere& ball, Vec3d inside, Vec3d to) const {
  if (!roof_.shapes(ball.radius)) return inside;
  for (int i = 0; i < kMostShifts; ++i) {
    const Vec3d along = to - inside;
    const auto way = way_below_roof(ball, roof_, along * (1 / length(along)), radius_);
    if (!way) return inside;
    const double excess = dot(inside - ball.centre, way->across) - way->highest;
    if (excess <= 0) return inside;
    inside = inside - way->across * excess;
  }
  return inside;
}

std::optional<Channel> ChannelWays::out_of_top(std::uint32_t lower, std::uint32_t upper) const {
  const Sphere& ball = spheres_[lower];
  if (!has_top_for(radius_, ball, roof_)) return std::nullopt;
  const Vec3d start = ball.centre + roof_.up * top_opening_height(radius_, ball.radius, roof_);
  const auto tube = tube_into(spheres_[upper], start, roof_.up, radius_);
  if (!tube || length(tube->end - tube->start) > longest_ ||
      !opens_below_roof(*tube, TubeEnd::end, spheres_[upper], roof_)) {
    return std::nullopt;
  }
  return Channel{lower, upper, *tube};
}

std::uint64_t ChannelWays::key_of(std::uint32_t a, std::uint32_t b, std::size_t way) const {
  return (static_cast<std::uint64_t>(std::min(a, b)) * spheres_.size() + std::max(a, b)) * kCount + way;
}

const std::optional<Channel>& ChannelWays::channel(std::uint32_t a, std::uint32_t b, std::size_t way) {
  const auto [place, is_new] = channels_.try_emplace(key_of(a, b, way));
  if (is_new) place->second = find_channel(a, b, way);
  return place->second;
}

double ChannelWays::sill(const Channel& channel, std::size_t way, Vec3d up) {
  auto& sills = sills_[dot(up, roof_.up) > 0 ? 0 : 1];
  const auto [place, is_new] = sills.try_emplace(key_of(channel.from, channel.to, way), 0);
  if (is_new) place->second = sill_of(channel.tube, spheres_[channel.from], spheres_[channel.to], up);
  return place->second;
}

std::optional<Channel> ChannelWays::find_channel(std::uint32_t a, std::uint32_t b, std::size_t way) const {
  const Vec3d up = roof_.up;
  const double height_a = dot(spheres_[a].centre, up), height_b = dot(spheres_[b].centre, up);
  if (height_a > height_b || (height_a == height_b && a > b)) std::swap(a, b);
  const Sphere& lower = spheres_[a];
  const Sphere& upper = spheres_[b];
  if (way == kOutOfTop) return out_of_top(a, b);
  const Attachment where = kAttachments[way];
  Vec3d inside_lower = lower.centre + up * (where.lower * lower.radius);
  const Vec3d inside_upper = upper.centre + up * (where.upper * upper.radius);
  // Off the centres only where that leaves a channel which does not fall from the lower to the upper.
  if ((where.lower != 0 || where.upper != 0) && dot(inside_upper - inside_lower, up) < -kLevel)
    return std::nullopt;
  inside_lower = below_roof(lower, inside_lower, inside_upper);
  const auto tube = tube_between(lower, upper, inside_lower, inside_upper, radius_);
  if (!tube || length(tube->end - tube->start) > longest_ || !is_bridged(*tube, roof_) ||
      !opens_below_roof(*tube, TubeEnd::start, lower, roof_) ||
      !opens_below_roof(*tube, TubeEnd::end, upper, roof_)) {
    return std::nullopt;
  }
  return Channel{a, b, *tube};
}

bool ChannelWays::is_free(const Channel& channel, std::size_t way) {
  const std::uint64_t key = key_of(channel.from, channel.to, way);
  const auto known = free_.find(key);
  if (known != free_.end()) return known->second;
  const bool is_free = clearance_.keeps_gap_to_voids(channel.tube, channel.from, channel.to) &&
                       clearance_.keeps_wall(channel.tube);
  free_.emplace(key, is_free);
  return is_free;
}

}  // namespace aerate
