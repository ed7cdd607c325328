#include "printing/cells/keep_wall.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/facet_distance.h"

namespace aerate {
namespace {

// Or the wall, if that is less.
double distance_to_model(const kernels::Facet& facet, const CellRegion& region) {
  const NearFacets& model = region.near_facets();
  FacetDistance distance(facet, region.wall());
  model.for_each_near(distance.middle(), region.wall() + distance.reach(),
                      [&](std::uint32_t i) { distance.look_at(model.facet(i)); });
  return distance.distance();
}

}  // namespace

double keep_wall(const CellRegion& region, std::vector<PlacedVertex>& vertices,
                 const std::vector<Triangle>& triangles) {
  constexpr int kMostRounds = 12;
  // Further than is missing, since a neighbour may not move.
  constexpr double kFurther = 1.2, kLeastStep = 2e-5;  // mm
  std::vector<char> is_moved(vertices.size(), 1);
  std::vector<double> push(vertices.size()), moved(vertices.size(), 0);
  for (int round = 0; round < kMostRounds; ++round) {
    std::fill(push.begin(), push.end(), 0.0);
    bool is_kept = true;
    for (const Triangle& t : triangles) {
      if (is_moved[t[0]] == 0 && is_moved[t[1]] == 0 && is_moved[t[2]] == 0) continue;
      const kernels::Facet facet{to_float(vertices[t[0]].at), to_float(vertices[t[1]].at),
                                 to_float(vertices[t[2]].at)};
      const double missing = region.wall() - distance_to_model(facet, region);
      if (missing <= 0) continue;
      is_kept = false;
      for (const std::uint32_t v : t) push[v] = std::max(push[v], kFurther * missing + kLeastStep);
    }
    if (is_kept) break;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      is_moved[v] = push[v] > 0 ? 1 : 0;
      const Vec3d way = vertices[v].inward - vertices[v].at;
      const double distance = length(way);
      if (is_moved[v] == 0 || distance <= push[v]) continue;
      vertices[v].at = vertices[v].at + way * (push[v] / distance);
      moved[v] += push[v];
    }
  }
  return vertices.empty() ? 0 : *std::ranges::max_element(moved);
}

}  // namespace aerate
