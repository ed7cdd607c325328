#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>

#include "core/drainage.h"
#include "core/roof.h"
#include "kernels/sphere.h"
#include "packing/tube_clearance.h"

namespace aerate {

// The straight channels that may join two voids: a few heights at which their axis may leave the lower one
// and enter the upper, and straight up out of the top of a roof. Steep channels between the top of one and
// the bottom of the other leave no pools; those through the centres find a way most often.
class ChannelWays {
 public:
  static constexpr std::size_t kCount = 8;

  // Channels of this radius (mm), none longer than `longest`. Spheres and clearance must outlive this.
  ChannelWays(std::span<const Sphere> spheres, const Roof& roof, double radius, double longest,
              const TubeClearance& clearance);

  // The channel of a way, from the lower to the upper void; nullopt if it cannot open into both of them all
  // round and below their roofs, or is too long, or leans so far that its own ceiling is wider than the
  // bridge. Remembered.
  const std::optional<Channel>& channel(std::uint32_t a, std::uint32_t b, std::size_t way);

  // The height along `up`, which is the roof's or the opposite, that liquid has to reach to pass it;
  // remembered.
  double sill(const Channel& channel, std::size_t way, Vec3d up);

  // Whether the channel of a way keeps clear of everything but other channels; remembered.
  bool is_free(const Channel& channel, std::size_t way);

 private:
  std::uint64_t key_of(std::uint32_t a, std::uint32_t b, std::size_t way) const;
  std::optional<Channel> find_channel(std::uint32_t a, std::uint32_t b, std::size_t way) const;
  Vec3d below_roof(const Sphere& ball, Vec3d inside, Vec3d to) const;
  std::optional<Channel> out_of_top(std::uint32_t lower, std::uint32_t upper) const;

  std::span<const Sphere> spheres_;
  Roof roof_;
  double radius_;
  double longest_;
  const TubeClearance& clearance_;
  // By pair and way; sills for print orientation and upside down.
  std::unordered_map<std::uint64_t, bool> free_;
  std::unordered_map<std::uint64_t, std::optional<Channel>> channels_;
  std::array<std::unordered_map<std::uint64_t, double>, 2> sills_;
};

}  // namespace aerate
