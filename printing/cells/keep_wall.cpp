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
                 const std::vector<Triangle>& triangles, SharedWork& work) {
  constexpr int kMostRounds = 12;
  constexpr std::size_t kGrain = 256;
  // Further than is missing, since a neighbour may not move.
  constexpr double kFurther = 1.2, kLeastStep = 2e-5;  // mm
  std::vector<char> is_moved(vertices.size(), 1);
  std::vector<double> push(vertices.size()), moved(vertices.size(), 0), missing(triangles.size());
  for (int round = 0; round < kMostRounds; ++round) {
    work.for_each(triangles.size(), kGrain, [&](std::size_t i) {
      const Triangle& t = triangles[i];
      missing[i] = 0;
      if (is_moved[t[0]] == 0 && is_moved[t[1]] == 0 && is_moved[t[2]] == 0) return;
      const kernels::Facet facet{to_float(vertices[t[0]].at), to_float(vertices[t[1]].at),
                                 to_float(vertices[t[2]].at)};
      missing[i] = region.wall() - distance_to_model(facet, region);
    });
    std::fill(push.begin(), push.end(), 0.0);
    bool is_kept = true;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (missing[i] <= 0) continue;
      is_kept = false;
      for (const std::uint32_t v : triangles[i])
        push[v] = std::max(push[v], kFurther * missing[i] + kLeastStep);
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
