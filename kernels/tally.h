#pragma once

#include <cstdint>

#include "kernels/annotations.h"

namespace aerate::kernels {

// How many elements go to each of up to three lists; what an executor's `select` adds up.
struct Tally {
  std::uint32_t first, second, third;

  friend AERATE_HD Tally operator+(Tally a, Tally b) {
    return {a.first + b.first, a.second + b.second, a.third + b.third};
  }
};

}  // namespace aerate::kernels
