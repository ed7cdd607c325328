#include "supports/pixels.h"

#include <algorithm>

namespace aerate {

std::vector<float> Pixels::squared_distances(bool value, int reach) const {
  const auto far = static_cast<float>((reach + 1) * (reach + 1));
  std::vector<float> rows(set_.size(), far), all(set_.size(), far);
  std::vector<std::uint8_t> is_far(count_y_, 1);  // rows without that value
  for_each_row([&](std::uint32_t y) {
    const std::size_t row = static_cast<std::size_t>(y) * count_x_;
    const auto sweep = [&](std::size_t i, int& since) {
      since = (set_[i] != 0) == value ? 0 : std::min(since + 1, reach + 1);
      rows[i] = std::min(rows[i], static_cast<float>(since * since));
      if (since == 0) is_far[y] = 0;
    };
    int since = reach + 1;
    for (std::size_t x = 0; x < count_x_; ++x) sweep(row + x, since);
    since = reach + 1;
    for (std::size_t x = count_x_; x-- > 0;) sweep(row + x, since);
  });
  for_each_row([&](std::uint32_t y) {
    const int from = std::max(0, static_cast<int>(y) - reach);
    const int to = std::min(static_cast<int>(count_y_) - 1, static_cast<int>(y) + reach);
    const std::size_t here = static_cast<std::size_t>(y) * count_x_;
    for (int other = from; other <= to; ++other) {
      if (is_far[static_cast<std::size_t>(other)] != 0) continue;
      const auto by = static_cast<float>((other - static_cast<int>(y)) * (other - static_cast<int>(y)));
      const std::size_t there = static_cast<std::size_t>(other) * count_x_;
      for (std::size_t x = 0; x < count_x_; ++x)
        all[here + x] = std::min(all[here + x], rows[there + x] + by);
    }
  });
  return all;
}

std::vector<std::pair<int, int>> disc_of(double pixels) {
  const int reach = static_cast<int>(pixels);
  std::vector<std::pair<int, int>> disc;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx)
      if (dx * dx + dy * dy <= pixels * pixels) disc.emplace_back(dx, dy);
  std::ranges::stable_sort(disc, {},
                           [](std::pair<int, int> d) { return d.first * d.first + d.second * d.second; });
  return disc;
}

}  // namespace aerate
