#pragma once

#include <bit>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "core/packing.h"

namespace aerate::test {

// Bits are compared and not values, so that 0 and -0 differ and a NaN equals itself.
inline void expect_same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(std::bit_cast<std::uint64_t>(a[i]), std::bit_cast<std::uint64_t>(b[i]))
        << "value " << i << ": " << a[i] << " and " << b[i];
  }
}

inline void expect_same_spheres(const std::vector<Sphere>& a, const std::vector<Sphere>& b) {
  ASSERT_EQ(a.size(), b.size());
  std::vector<double> numbers_a, numbers_b;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].kind, b[i].kind) << "sphere " << i;
    for (const double x : {a[i].centre.x, a[i].centre.y, a[i].centre.z, a[i].radius}) numbers_a.push_back(x);
    for (const double x : {b[i].centre.x, b[i].centre.y, b[i].centre.z, b[i].radius}) numbers_b.push_back(x);
  }
  expect_same_bits(numbers_a, numbers_b);
}

inline void expect_same_packing(const Packing& a, const Packing& b) {
  expect_same_spheres(a.spheres, b.spheres);
  EXPECT_EQ(a.statistics.candidates, b.statistics.candidates);
  EXPECT_EQ(a.statistics.outside, b.statistics.outside);
  EXPECT_EQ(a.statistics.overlapped_region, b.statistics.overlapped_region);
  EXPECT_EQ(a.statistics.near_surface, b.statistics.near_surface);
  EXPECT_EQ(a.statistics.below_min_radius, b.statistics.below_min_radius);
}

}  // namespace aerate::test
