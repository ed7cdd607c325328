#pragma once

#include <array>

#include "kernels/vec.h"

namespace aerate {

// x -> A x + b, row by row: {A | b}.
struct Affine {
  std::array<std::array<double, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  Vec3d operator()(Vec3d p) const {
    const auto row = [&](const std::array<double, 4>& r) {
      return r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3];
    };
    return {row(rows[0]), row(rows[1]), row(rows[2])};
  }

  // First `b`, then `a`.
  friend Affine operator*(const Affine& a, const Affine& b) {
    Affine product;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        double sum = j == 3 ? a.rows[i][3] : 0;
        for (std::size_t k = 0; k < 3; ++k) sum += a.rows[i][k] * b.rows[k][j];
        product.rows[i][j] = sum;
      }
    }
    return product;
  }

  // A mirroring turns triangles inside out.
  bool mirrors() const {
    const auto row = [&](std::size_t i) { return Vec3d{rows[i][0], rows[i][1], rows[i][2]}; };
    return dot(row(0), cross(row(1), row(2))) < 0;
  }

  friend bool operator==(const Affine&, const Affine&) = default;
};

}  // namespace aerate
