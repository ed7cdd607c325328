#pragma once

#include <bit>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "kernels/cell_planes.h"

namespace aerate::test {

// Bits are compared and not values, so that 0 and -0 differ.
inline void expect_same_cells(const CellPlanes& a, const CellPlanes& b) {
  const auto bits_of = [](const CellPlanes& cells) {
    std::vector<std::uint64_t> bits;
    const auto add = [&bits](Vec3d v) {
      for (const double x : {v.x, v.y, v.z}) bits.push_back(std::bit_cast<std::uint64_t>(x));
    };
    for (const CellPlane& plane : cells.planes) {
      add(plane.normal);
      bits.push_back(std::bit_cast<std::uint64_t>(plane.offset));
      bits.push_back(plane.neighbour);
    }
    for (const Box3d& box : cells.boxes) {
      add(box.lower);
      add(box.upper);
    }
    return bits;
  };
  EXPECT_EQ(a.first, b.first);
  EXPECT_TRUE(bits_of(a) == bits_of(b));
}

}  // namespace aerate::test
