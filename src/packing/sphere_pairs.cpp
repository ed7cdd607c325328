#include "packing/sphere_pairs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "kernels/constants.h"
#include "kernels/packed_shape.h"
#include "kernels/roof_distance.h"

namespace aerate {
namespace {

// The spheres of one radius class, sorted by the cell of their centre. A cell is as wide as the farthest that
// two spheres of the class can be apart and still be a pair, so that neighbours are in adjacent cells.
class RadiusClass {
 public:
  RadiusClass(std::span<const Sphere> spheres, const std::vector<std::uint32_t>& members,
              double largest_radius, double reach, Vec3d origin)
      : largest_radius_(largest_radius), cell_size_(2 * largest_radius + reach), origin_(origin) {
    entries_.reserve(members.size());
    for (const std::uint32_t i : members) {
      const Vec3d c = spheres[i].centre;
      entries_.push_back({key(cell(c.x - origin_.x), cell(c.y - origin_.y), cell(c.z - origin_.z)), i});
    }
    tbb::parallel_sort(entries_.begin(), entries_.end());
  }

  double largest_radius() const { return largest_radius_; }

  // Members whose centre may be within `distance` of `centre` along every axis.
  template <typename Visit>
  void for_each_near(Vec3d centre, double distance, Visit visit) const {
    const Vec3d c = centre - origin_;
    for (std::int64_t z = cell(c.z - distance); z <= cell(c.z + distance); ++z) {
      for (std::int64_t y = cell(c.y - distance); y <= cell(c.y + distance); ++y) {
        const std::uint64_t last = key(cell(c.x + distance), y, z);
        auto entry =
            std::lower_bound(entries_.begin(), entries_.end(), Entry{key(cell(c.x - distance), y, z), 0});
        for (; entry != entries_.end() && entry->key <= last; ++entry) visit(entry->sphere);
      }
    }
  }

 private:
  struct Entry {
    std::uint64_t key;
    std::uint32_t sphere;
    friend bool operator<(const Entry& a, const Entry& b) {
      return a.key != b.key ? a.key < b.key : a.sphere < b.sphere;
    }
  };

  // 21 bits for each axis; coordinates beyond share the border cells, which costs time and misses nothing.
  static constexpr std::int64_t kLastCell = (1 << 21) - 1;
  std::int64_t cell(double offset) const {
    return static_cast<std::int64_t>(
        std::clamp(std::floor(offset / cell_size_), 0.0, static_cast<double>(kLastCell)));
  }
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint64_t>(z << 42 | y << 21 | x);
  }

  double largest_radius_, cell_size_;
  Vec3d origin_;
  std::vector<Entry> entries_;
};

struct Classes {
  std::vector<RadiusClass> by_radius;   // ascending
  std::vector<std::uint8_t> of_sphere;  // index into by_radius
};

Classes classify(std::span<const Sphere> spheres, double reach) {
  std::map<int, std::vector<std::uint32_t>> members;
  Vec3d origin{kInfinity, kInfinity, kInfinity};
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    int exponent = 0;
    // Spheres smaller than the reach share a class: their cells would be no smaller.
    std::frexp(std::max(spheres[i].radius, reach), &exponent);
    members[exponent].push_back(static_cast<std::uint32_t>(i));
    origin = min_of(origin, spheres[i].centre);
  }
  Classes classes;
  classes.of_sphere.resize(spheres.size());
  for (const auto& [exponent, indices] : members) {
    double largest = 0;
    for (const std::uint32_t i : indices) {
      largest = std::max(largest, spheres[i].radius);
      classes.of_sphere[i] = static_cast<std::uint8_t>(classes.by_radius.size());
    }
    classes.by_radius.emplace_back(spheres, indices, largest, reach, origin);
  }
  return classes;
}

}  // namespace

std::vector<SpherePair> find_pairs_within(std::span<const Sphere> spheres, double reach, const Roof& roof) {
  const Classes classes = classify(spheres, reach);
  tbb::enumerable_thread_specific<std::vector<SpherePair>> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, spheres.size(), 256), [&](const auto& range) {
    std::vector<SpherePair>& pairs = found.local();
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const Sphere& sphere = spheres[i];
      const std::size_t own_class = classes.of_sphere[i];
      // The smaller of a pair looks among the larger: these have wide cells, so 27 of them are all there is.
      for (std::size_t k = own_class; k < classes.by_radius.size(); ++k) {
        const double largest = classes.by_radius[k].largest_radius();
        const double distance = kernels::RoofedShape{roof}.span(sphere.radius + largest + reach, largest);
        classes.by_radius[k].for_each_near(sphere.centre, distance, [&](std::uint32_t j) {
          if (k == own_class && j <= i) return;
          const double gap = kernels::distance_between(roof, sphere.centre, sphere.radius, spheres[j].centre,
                                                       spheres[j].radius);
          const auto self = static_cast<std::uint32_t>(i);
          if (gap < reach) pairs.push_back({std::min(self, j), std::max(self, j), gap});
        });
      }
    }
  });
  std::vector<SpherePair> all;
  for (const std::vector<SpherePair>& pairs : found) all.insert(all.end(), pairs.begin(), pairs.end());
  tbb::parallel_sort(all.begin(), all.end(), [](const SpherePair& a, const SpherePair& b) {
    return a.first != b.first ? a.first < b.first : a.second < b.second;
  });
  return all;
}

}  // namespace aerate
