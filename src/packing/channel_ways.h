#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/drainage.h"
#include "core/monitor.h"
#include "core/void_shape.h"
#include "packing/tube_clearance.h"

namespace aerate {

// A straight channel that may join two voids, from the lower to the upper. It opens into both of them all
// round and below their roofs, is not too long, and leans no further than its own ceiling is bridged.
struct ChannelWay {
  Channel channel;
  std::array<double, 2> sills;  // that liquid has to reach to pass it: in print orientation, and upside down

  std::uint32_t other_than(std::uint32_t at) const { return channel.from == at ? channel.to : channel.from; }
};

// All of them: a few heights at which their axis may leave the lower void and enter the upper, and straight
// up out of the top of a roof. Steep channels between the top of one and the bottom of the other leave no
// pools; those through the centres find a way most often.
class ChannelWays {
 public:
  // Channels of this radius (mm), none longer than `longest`. Clearance must outlive this.
  ChannelWays(std::span<const VoidShape> voids, const Roof& roof, double radius, double longest,
              const TubeClearance& clearance, Monitor& monitor);

  // Those between the same two voids follow each other, by what they are to be preferred.
  std::size_t size() const { return ways_.size(); }
  const ChannelWay& operator[](std::size_t way) const { return ways_[way]; }

  // Those from or to a void.
  std::span<const std::uint32_t> of(std::uint32_t at) const { return of_void_[at]; }

  // Does the channel of a way keep clear of everything but other channels? Remembered.
  bool is_free(std::size_t way);

 private:
  const TubeClearance& clearance_;
  std::vector<ChannelWay> ways_;
  std::vector<std::vector<std::uint32_t>> of_void_;
  std::vector<std::optional<bool>> free_;  // by way
};

}  // namespace aerate
