#pragma once

#include <cstdint>

#include "kernels/vec.h"

namespace aerate::kernels {

// Spreads the low 21 bits of x to every third bit.
AERATE_HD inline std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffffu;
  x = (x | x << 32) & 0x1f00000000ffffu;
  x = (x | x << 16) & 0x1f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  x = (x | x << 2) & 0x1249249249249249u;
  return x;
}

// Position along a 3-D Hilbert curve of 2^21 cells a side, after J. Skilling, "Programming the Hilbert
// curve", 2004 (axes to transpose). Neighbours on the curve are neighbours in space, without the Morton
// order's jumps, so runs of it have small boxes.
AERATE_HD inline std::uint64_t hilbert_key(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  constexpr std::uint32_t kTopBit = 1u << 20;
  for (std::uint32_t bit = kTopBit; bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    if ((x & bit) != 0) x ^= below;
    if ((y & bit) != 0) {
      x ^= below;
    } else {
      const std::uint32_t swap = (x ^ y) & below;
      x ^= swap;
      y ^= swap;
    }
    if ((z & bit) != 0) {
      x ^= below;
    } else {
      const std::uint32_t swap = (x ^ z) & below;
      x ^= swap;
      z ^= swap;
    }
  }
  y ^= x;
  z ^= y;
  std::uint32_t flip = 0;
  for (std::uint32_t bit = kTopBit; bit > 1; bit >>= 1) {
    if ((z & bit) != 0) flip ^= bit - 1;
  }
  x ^= flip;
  y ^= flip;
  z ^= flip;
  return spread_bits(x) << 2 | spread_bits(y) << 1 | spread_bits(z);
}

// Maps points of a box to keys along the curve.
class CurveFrame {
 public:
  explicit CurveFrame(const Box3d& box) : origin_(box.lower), cells_per_mm_(0) {
    const Vec3d size = box.upper - box.lower;
    const double longest = max_of(size.x, max_of(size.y, size.z));
    if (longest > 0) cells_per_mm_ = kCells / longest;
  }

  AERATE_HD std::uint64_t key(Vec3d p) const {
    return hilbert_key(cell(p.x - origin_.x), cell(p.y - origin_.y), cell(p.z - origin_.z));
  }

 private:
  static constexpr double kCells = 2097152.0;

  AERATE_HD std::uint32_t cell(double distance) const {
    return static_cast<std::uint32_t>(min_of(max_of(distance * cells_per_mm_, 0.0), kCells - 1));
  }

  Vec3d origin_;
  double cells_per_mm_;
};

}  // namespace aerate::kernels
