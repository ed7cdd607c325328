#include "printing/cells/nearest_in_halfspaces.h"

#include <algorithm>
#include <cmath>

namespace aerate {

Vec3d Halfspaces::nearest_to(Vec3d p) const {
  constexpr int kMostRounds = 100;
  constexpr double kCloseEnough = 1e-7;  // mm
  std::array<double, kMost> pushes{};
  for (int round = 0; round < kMostRounds; ++round) {
    double most = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      // A half-space pushes, and takes back no more than it has pushed.
      const double push = std::max(-pushes[i], dot(all_[i].normal, p) - all_[i].offset);
      pushes[i] += push;
      p = p - all_[i].normal * push;
      most = std::max(most, std::abs(push));
    }
    if (most < kCloseEnough) break;
  }
  return p;
}

}  // namespace aerate
