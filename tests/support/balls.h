#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "kernels/packed_shape.h"
#include "kernels/vec.h"

namespace aerate::test {

inline Vec3d random_point(std::mt19937& random, const Box3d& box) {
  std::uniform_real_distribution<double> share(0, 1);
  const double x = share(random), y = share(random), z = share(random);
  const Vec3d size = box.upper - box.lower;
  return box.lower + Vec3d{x * size.x, y * size.y, z * size.z};
}

// Adds balls at random places of the box, each as large as those before and `largest` let it be, at least
// `gap` from all and none smaller than `smallest`, until there are so many.
inline void add_random_balls(std::vector<kernels::Ball>& balls, std::size_t count, const Box3d& box,
                             double smallest, double largest, double gap, unsigned seed) {
  std::mt19937 random(seed);
  while (balls.size() < count) {
    const Vec3d p = random_point(random, box);
    double radius = largest;
    for (const kernels::Ball& ball : balls) {
      radius = std::min(radius, length(ball.centre - p) - ball.radius - gap);
    }
    if (radius >= smallest) balls.push_back({p, radius});
  }
}

// Face-centred cubic lattice of touching balls, `count` cubes of four balls along each axis.
inline std::vector<kernels::Ball> face_centred_balls(int count, double cube) {
  std::vector<kernels::Ball> balls;
  for (int z = 0; z < 2 * count; ++z) {
    for (int y = 0; y < 2 * count; ++y) {
      for (int x = 0; x < 2 * count; ++x) {
        if ((x + y + z) % 2 != 0) continue;
        balls.push_back({Vec3d{x + 0.5, y + 0.5, z + 0.5} * (cube / 2), cube / std::sqrt(8.0)});
      }
    }
  }
  return balls;
}

}  // namespace aerate::test
