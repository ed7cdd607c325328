#pragma once

#include <cstdint>

#include "kernels/annotations.h"
#include "kernels/view.h"

namespace aerate::kernels {

// How many elements go to each of up to three lists; what an executor's `select` adds up.
struct Tally {
  std::uint32_t first, second, third;

  friend AERATE_HD Tally operator+(Tally a, Tally b) {
    return {a.first + b.first, a.second + b.second, a.third + b.third};
  }
};

// For `select`: of elements that are marked with 1, and not with 0.
struct TallyMarked {
  View<const std::uint8_t> marks;

  AERATE_HD Tally operator()(std::size_t i) const { return {marks[i], 0u, 0u}; }
};

}  // namespace aerate::kernels
