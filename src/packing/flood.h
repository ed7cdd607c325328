#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "kernels/constants.h"
#include "packing/drainage_draft.h"

namespace aerate {

// The way along which the liquid of a void has to rise least to run out begins with this channel.
struct FloodStep {
  double height;           // that liquid has to reach
  double length;           // of a channel that is not there yet
  std::uint32_t to, from;  // the void, or kNone if no way leads to it; and that before it, or kNone
  std::size_t way;         // of ChannelWays, or kExistingChannel
};
inline constexpr std::size_t kExistingChannel = std::numeric_limits<std::size_t>::max();

// Finds those ways, by void, for all that can be reached from the lowest hole of their network, along
// channels that are there and those that can be made, in order of that height; `up` is against gravity.
// `make` is called for each channel that would be the next; the flood takes it if that returns true.
std::vector<FloodStep> flood(const DrainageTask& task, const Draft& draft, Vec3d up,
                             const std::function<bool(std::size_t way)>& make);

}  // namespace aerate
