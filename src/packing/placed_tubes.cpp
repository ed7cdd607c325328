#include "packing/placed_tubes.h"

#include <algorithm>
#include <cmath>

#include "core/segment_distance.h"

namespace aerate {

double tube_spacing(double radius, double other_radius) {
  return radius + other_radius + kOpeningSpacingShare * std::max(radius, other_radius);
}

PlacedTubes::PlacedTubes(const Roof& roof, double gap, double longest, double widest_radius)
    : gap_(gap),
      cell_size_(longest + 2 * widest_radius + std::max(gap, kOpeningSpacingShare * widest_radius)) {
  plan_.roof = roof;
}

std::uint64_t PlacedTubes::cell_of(const Tube& tube, int dx, int dy, int dz) const {
  const Vec3d middle = (tube.start + tube.end) * 0.5;
  const auto cell = [this](double x, int offset) {
    constexpr std::int64_t kMiddle = 1 << 20;
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x / cell_size_)) + offset +
                                      kMiddle) &
           0x1fffff;
  };
  return cell(middle.x, dx) << 42 | cell(middle.y, dy) << 21 | cell(middle.z, dz);
}

bool PlacedTubes::keep_clear_of(const Tube& tube, std::uint32_t from, std::uint32_t to) const {
  const auto is_clear_of = [&](const Placed& placed) {
    const bool meet = placed.from == from || placed.from == to || placed.to == from || placed.to == to;
    const double openings = tube_spacing(tube.radius, placed.tube.radius);
    const double spacing = meet ? openings : std::max(openings, tube.radius + placed.tube.radius + gap_);
    return distance_between({tube.start, tube.end}, {placed.tube.start, placed.tube.end}) >= spacing;
  };
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto found = cells_.find(cell_of(tube, dx, dy, dz));
        if (found != cells_.end() && !std::all_of(found->second.begin(), found->second.end(), is_clear_of))
          return false;
      }
    }
  }
  return true;
}

void PlacedTubes::enter(const Placed& placed) {
  cells_[cell_of(placed.tube, 0, 0, 0)].push_back(placed);
}

void PlacedTubes::place(const Channel& channel) {
  plan_.channels.push_back(channel);
  enter({channel.tube, channel.from, channel.to});
}

void PlacedTubes::place(const EscapeHole& hole) {
  plan_.holes.push_back(hole);
  enter({hole.tube, hole.from, hole.from});
}

void PlacedTubes::remove_tubes_of(const std::function<bool(std::uint32_t)>& is_such) {
  std::erase_if(plan_.channels, [&](const Channel& c) { return is_such(c.from) || is_such(c.to); });
  std::erase_if(plan_.holes, [&](const EscapeHole& hole) { return is_such(hole.from); });
  for (auto& [cell, placed] : cells_)
    std::erase_if(placed, [&](const Placed& tube) { return is_such(tube.from) || is_such(tube.to); });
}

}  // namespace aerate
