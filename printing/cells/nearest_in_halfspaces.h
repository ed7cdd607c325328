#pragma once

#include <array>
#include <cstddef>

#include "kernels/vec.h"

namespace aerate {

// Holds points with dot(normal, x) <= offset.
struct Halfspace {
  Vec3d normal{0, 0, 0};
  double offset = 0;
};

// A few half-spaces; more than it has room for are left out.
class Halfspaces {
 public:
  static constexpr std::size_t kMost = 32;

  void add(Vec3d normal, double offset) {
    if (size_ < kMost) all_[size_++] = {normal, offset};
  }
  std::size_t size() const { return size_; }
  const Halfspace& operator[](std::size_t i) const { return all_[i]; }

  // Of the points in all of them the nearest to `p`, to 1e-7 mm, or near it: by Hildreth's method (C. Hildreth,
  // "A quadratic programming procedure", 1957).
  Vec3d nearest_to(Vec3d p) const;

 private:
  std::array<Halfspace, kMost> all_;
  std::size_t size_ = 0;
};

}  // namespace aerate
