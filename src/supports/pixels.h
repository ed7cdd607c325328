#pragma once

#include <cstddef>
#include <cstdint>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace aerate {

// Pixels of one layer, each set or not.
class Pixels {
 public:
  Pixels(std::uint32_t count_x, std::uint32_t count_y)
      : count_x_(count_x), count_y_(count_y), set_(static_cast<std::size_t>(count_x) * count_y, 0) {}

  std::uint8_t& operator[](std::size_t i) { return set_[i]; }
  std::uint8_t operator[](std::size_t i) const { return set_[i]; }
  std::size_t size() const { return set_.size(); }

  // Squared distance of each pixel to the nearest one whose value is `value`, in pixels, up to `reach` (P. Felzenszwalb and
  // D. Huttenlocher, "Distance transforms of sampled functions", by brute force over a short reach).
  std::vector<float> squared_distances(bool value, int reach) const;

  template <typename F>
  void for_each_row(const F& f) const {
    constexpr std::uint32_t kGrain = 32;
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count_y_, kGrain),
                      [&](const tbb::blocked_range<std::uint32_t>& range) {
                        for (std::uint32_t y = range.begin(); y < range.end(); ++y) f(y);
                      });
  }

 private:
  std::uint32_t count_x_, count_y_;
  std::vector<std::uint8_t> set_;
};

// Columns no farther than this from one, as steps; the nearest first.
std::vector<std::pair<int, int>> disc_of(double pixels);

}  // namespace aerate
