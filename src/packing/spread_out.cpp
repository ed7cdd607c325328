#include "packing/spread_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>

namespace aerate {
namespace {

using Place = std::array<std::int64_t, 3>;

// Points by the cube of a lattice that they are in; no two are nearer to each other than a cube is wide.
class SpreadPoints {
 public:
  explicit SpreadPoints(double spacing) : spacing_(spacing) {}

  bool add(Vec3d point) {
    const Place own = place_of(point);
    for (std::int64_t x = own[0] - 1; x <= own[0] + 1; ++x) {
      for (std::int64_t y = own[1] - 1; y <= own[1] + 1; ++y) {
        for (std::int64_t z = own[2] - 1; z <= own[2] + 1; ++z) {
          const auto found = points_.find({x, y, z});
          if (found == points_.end()) continue;
          if (std::ranges::any_of(found->second,
                                  [&](Vec3d other) { return length(other - point) < spacing_; }))
            return false;
        }
      }
    }
    points_[own].push_back(point);
    return true;
  }

 private:
  Place place_of(Vec3d point) const {
    const auto index = [&](double x) { return static_cast<std::int64_t>(std::floor(x / spacing_)); };
    return {index(point.x), index(point.y), index(point.z)};
  }

  double spacing_;
  std::map<Place, std::vector<Vec3d>> points_;
};

}  // namespace

std::vector<Sphere> spread_out(std::span<const Sphere> spheres, double spacing) {
  std::vector<std::size_t> order(spheres.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return spheres[a].radius > spheres[b].radius; });
  SpreadPoints kept(spacing);
  std::erase_if(order, [&](std::size_t i) { return !kept.add(spheres[i].centre); });
  std::ranges::sort(order);
  std::vector<Sphere> result;
  result.reserve(order.size());
  for (const std::size_t i : order) result.push_back(spheres[i]);
  return result;
}

}  // namespace aerate
