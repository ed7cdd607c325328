#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "kernels/constants.h"
#include "kernels/vec.h"
#include "kernels/view.h"

namespace aerate::kernels {

// A triangle with its corners at hand: one fetch where indices would take four.
struct Facet {
  Vec3f a, b, c;

  // By number, for loops over a facet in memory.
  AERATE_HD const Vec3f& corner(int i) const { return i == 0 ? a : i == 1 ? b : c; }
};

// A box that holds nothing, and to which anything can be added.
AERATE_HD inline Box3f empty_box() {
  constexpr auto kFar = static_cast<float>(kInfinity);
  return {{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
}

AERATE_HD inline Box3f box_of(const Facet& f) {
  return {min_of(f.a, min_of(f.b, f.c)), max_of(f.a, max_of(f.b, f.c))};
}

AERATE_HD inline Box3f united(const Box3f& a, const Box3f& b) {
  return {min_of(a.lower, b.lower), max_of(a.upper, b.upper)};
}

struct FacetIndices {
  std::uint32_t a, b, c;
};

struct GatherFacet {
  View<const Vec3f> positions;
  View<const FacetIndices> triangles;
  View<Facet> facets;

  AERATE_HD void operator()(std::size_t i) const {
    const FacetIndices t = triangles[i];
    facets[i] = {positions[t.a], positions[t.b], positions[t.c]};
  }
};

// The facets of an indexed mesh in the executor's memory, in the mesh's order.
template <typename Executor>
typename Executor::template Buffer<Facet> gather_facets(
    const Executor& executor, std::span<const Vec3f> positions,
    std::span<const std::array<std::uint32_t, 3>> triangles) {
  static_assert(sizeof(FacetIndices) == sizeof(triangles[0]));
  const auto device_positions = executor.upload(positions);
  const auto device_triangles = executor.upload(std::span<const FacetIndices>(
      reinterpret_cast<const FacetIndices*>(triangles.data()), triangles.size()));
  auto facets = executor.template allocate<Facet>(triangles.size());
  executor.for_each_index(triangles.size(),
                          GatherFacet{device_positions.view(), device_triangles.view(), facets.view()});
  return facets;
}

}  // namespace aerate::kernels
