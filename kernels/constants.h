#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace aerate {

// In place of an index: there is none.
inline constexpr std::uint32_t kNone = 0xffffffffu;

// What an executor's free_bytes() is where nobody has to do with less.
inline constexpr std::size_t kAsMuchAsIsWanted = std::numeric_limits<std::size_t>::max();

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace aerate
