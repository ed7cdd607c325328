#include "printing/cells/near_facets.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/point_triangle.h"

namespace aerate {

NearFacets::Search::Search(const NearFacets& facets, Vec3d at, double limit_squared)
    : p(to_float(at)),
      error(facets.error_ + std::ldexp(std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}), -22)) {
  set_limit(limit_squared);
}

void NearFacets::Search::set_limit(double limit_squared) {
  // Errors of squares: 2 d e <= d^2 / 10^6 + 10^6 e^2.
  constexpr double kShare = 1e-6;
  const double reach = std::sqrt(limit_squared) + 2 * error;
  limit = static_cast<float>(std::min(reach * reach * (1 + kShare), 1e38));
  limit_of_disc =
      static_cast<float>(std::min(limit_squared * (1 + 4 * kShare) + 8 * error * error / kShare, 1e38));
}

NearFacets::NearFacets(const kernels::TriangleBvhView& bvh) : bvh_(bvh) {
  const std::size_t used = (bvh.facets.size + 3) / 4;
  std::uint32_t leaves = 1;
  while (leaves < used) leaves *= 4;
  first_leaf_ = (leaves - 1) / 3;
  std::vector<Box3f> box_of_node(first_leaf_ + std::size_t{leaves}, kernels::empty_box());
  discs_.resize(used);
  for (std::size_t i = 0; i < 4 * used; ++i) {
    set_disc(i);
    if (i >= bvh.facets.size) continue;
    Box3f& box = box_of_node[first_leaf_ + i / 4];
    box = kernels::united(box, kernels::box_of(bvh.facets[i]));
  }
  boxes_.resize(first_leaf_);
  for (std::size_t node = first_leaf_; node-- > 0;) {
    for (std::size_t i = 0; i < 4; ++i) {
      const Box3f& box = box_of_node[4 * node + 1 + i];
      box_of_node[node] = kernels::united(box_of_node[node], box);
      // Empty ones are farther than any limit, without an overflow.
      constexpr float kFar = 1e19F;
      const bool is_empty = box.lower.x > box.upper.x;
      boxes_[node].lower_x[i] = is_empty ? kFar : box.lower.x;
      boxes_[node].lower_y[i] = is_empty ? kFar : box.lower.y;
      boxes_[node].lower_z[i] = is_empty ? kFar : box.lower.z;
      boxes_[node].upper_x[i] = is_empty ? kFar : box.upper.x;
      boxes_[node].upper_y[i] = is_empty ? kFar : box.upper.y;
      boxes_[node].upper_z[i] = is_empty ? kFar : box.upper.z;
    }
  }
  const Box3f& all = box_of_node[0];
  float largest = 0;
  for (const Vec3f p : {all.lower, all.upper})
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  error_ = std::ldexp(bvh.facets.size == 0 ? 0.0 : static_cast<double>(largest), -22);
}

void NearFacets::set_disc(std::size_t i) {
  Discs& discs = discs_[i / 4];
  const std::size_t n = i % 4;
  if (i >= bvh_.facets.size) return;
  const kernels::Facet& facet = bvh_.facets[i];
  const Vec3d a = to_double(facet.a), b = to_double(facet.b), c = to_double(facet.c);
  const Vec3d centre = (a + b + c) * (1.0 / 3);
  const double radius = std::sqrt(
      std::max({length_squared(a - centre), length_squared(b - centre), length_squared(c - centre)}));
  Vec3d normal = cross(b - a, c - a);
  // Of a needle the normal is not worth much.
  constexpr double kLeastShape = 1e-6;
  const double size = length(normal);
  normal = size > kLeastShape * radius * radius ? normal * (1 / size) : Vec3d{0, 0, 0};
  discs.x[n] = static_cast<float>(centre.x);
  discs.y[n] = static_cast<float>(centre.y);
  discs.z[n] = static_cast<float>(centre.z);
  discs.normal_x[n] = static_cast<float>(normal.x);
  discs.normal_y[n] = static_cast<float>(normal.y);
  discs.normal_z[n] = static_cast<float>(normal.z);
  discs.radius[n] = static_cast<float>(radius * (1 + 1e-6));
}

kernels::NearestFacet NearFacets::nearer_than(Vec3d p, kernels::NearestFacet best) const {
  Search search(*this, p, best.distance_squared);
  walk(search, [&](std::uint32_t i) {
    const double squared = kernels::distance_squared_to_facet(p, bvh_.facets[i]);
    if (squared >= best.distance_squared) return;
    best = {squared, i};
    search.set_limit(squared);
  });
  return best;
}

}  // namespace aerate
