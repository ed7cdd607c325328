#include "supports/overhangs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <queue>
#include <utility>

#include "core/disjoint_sets.h"
#include "core/upright.h"

namespace aerate {
namespace {

constexpr std::array<std::pair<int, int>, 4> kForward{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};

// Of ceilings that lean out beyond the angle, the distance to where these end, mm: half a column at the rim.
std::vector<double> depths(const Undersides& columns) {
  struct At {
    double depth;
    std::uint32_t span;
    double from_x, from_y;  // columns
    bool operator<(const At& other) const {
      return depth != other.depth ? depth > other.depth : span > other.span;
    }
  };
  std::vector<double> depth(columns.spans.size(), kInfinity);
  std::priority_queue<At> open;
  const auto offer = [&](std::uint32_t span, double from_x, double from_y) {
    const double far = columns.spacing * std::hypot(columns.x_of(span) - from_x, columns.y_of(span) - from_y);
    if (far >= depth[span]) return;
    depth[span] = far;
    open.push({far, span, from_x, from_y});
  };
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (columns.hold[i] != Hold::bridge) continue;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        if (dx == 0 && dy == 0) continue;
        const std::uint32_t other = columns.next(i, dx, dy);
        if (other == kNoSpan || columns.hold[other] != Hold::bridge)
          offer(i, columns.x_of(i) + 0.5 * dx, columns.y_of(i) + 0.5 * dy);
      }
    }
  }
  while (!open.empty()) {
    const At at = open.top();
    open.pop();
    if (at.depth > depth[at.span]) continue;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        const std::uint32_t other = columns.next(at.span, dx, dy);
        if (other != kNoSpan && columns.hold[other] == Hold::bridge) offer(other, at.from_x, at.from_y);
      }
    }
  }
  return depth;
}

}  // namespace

double Overhangs::area() const {
  return std::accumulate(regions.begin(), regions.end(), 0.0,
                         [](double sum, const OverhangRegion& region) { return sum + region.area; });
}

std::vector<OverhangRegion> overhang_regions(const Undersides& columns, const SupportRules& rules) {
  const std::vector<double> distances = distances_from_hold(columns, {});
  const std::vector<double> depth = depths(columns);
  const auto leans = [&](std::uint32_t span) { return columns.hold[span] == Hold::bridge; };
  const std::vector<bool> is_tip = [&] {
    std::vector<bool> flags(columns.spans.size(), false);
    for (const std::uint32_t tip : columns.tips) flags[tip] = true;
    return flags;
  }();
  DisjointSets sets(columns.spans.size());
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    if (!leans(i)) continue;
    for (const auto& [dx, dy] : kForward) {
      const std::uint32_t other = columns.next(i, dx, dy);
      if (other != kNoSpan && leans(other)) sets.join(i, other);
    }
  }
  std::vector<std::uint32_t> number(columns.spans.size(), kNoSpan);  // by root, of those that need supports
  std::vector<OverhangRegion> regions;
  std::vector<double> farthest;
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    const bool needs = is_tip[i] || (leans(i) && distances[i] > rules.reach);
    if (!needs) continue;
    const auto root = static_cast<std::uint32_t>(sets.root(i));
    if (number[root] == kNoSpan) {
      number[root] = static_cast<std::uint32_t>(regions.size());
      regions.emplace_back();
      farthest.push_back(-1);
    }
    OverhangRegion& region = regions[number[root]];
    double distance = distances[i];
    if (is_tip[i]) distance = kInfinity;
    const Vec3d place = columns.place(i);
    const bool is_further = distance > farthest[number[root]];
    if (is_further || (distance == farthest[number[root]] && place.z < region.place.z)) {
      farthest[number[root]] = distance;
      region.place = place;
    }
  }
  for (std::uint32_t i = 0; i < columns.spans.size(); ++i) {
    const auto root = static_cast<std::uint32_t>(sets.root(i));
    if (number[root] == kNoSpan || !(leans(i) || is_tip[i])) continue;
    OverhangRegion& region = regions[number[root]];
    region.area += columns.area();
    if (leans(i)) region.width = std::max(region.width, 2 * depth[i]);
  }
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (std::isfinite(farthest[i])) regions[i].farthest = farthest[i];
    regions[i].height = regions[i].place.z - columns.plate;
  }
  std::ranges::stable_sort(regions,
                           [](const OverhangRegion& a, const OverhangRegion& b) { return a.area > b.area; });
  return regions;
}

Overhangs find_overhangs(const Mesh& mesh, const SupportRules& rules, Vec3d up, Monitor& monitor) {
  const UprightFrame frame(up);
  const Mesh turned = frame.is_the_models_own() ? Mesh{} : turned_upright(mesh, frame);
  const Mesh& upright = frame.is_the_models_own() ? mesh : turned;
  const kernels::HostWinding winding(upright.positions, upright.triangles);
  monitor.check_interrupted();
  const double plate = static_cast<double>(bounding_box(upright).lower.z);
  const Undersides columns =
      find_undersides(upright, winding.view(), rules, plate, column_spacing(upright, rules));
  monitor.check_interrupted();
  Overhangs overhangs{columns.spacing, overhang_regions(columns, rules)};
  for (OverhangRegion& region : overhangs.regions)
    region.place = frame.x * region.place.x + frame.y * region.place.y + frame.z * region.place.z;
  return overhangs;
}

}  // namespace aerate
