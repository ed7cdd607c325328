#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/roof.h"
#include "kernels/sphere.h"

namespace aerate {

struct SpherePair {
  std::uint32_t first, second;  // first < second
  double gap;                   // distance between the two surfaces, mm; negative where they overlap
};

// All pairs of spheres, with the roofs that they take, nearer to each other than `reach` mm, ordered by
// (first, second). Spheres are binned by radius (powers of two), each class in a hashed grid of its own, so
// that few large spheres among many small ones cost nothing: O(n) for a packing, on all threads, the same for
// any number of them.
std::vector<SpherePair> find_pairs_within(std::span<const Sphere> spheres, double reach,
                                          const Roof& roof = {});

}  // namespace aerate
