#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernels/triangle_bvh.h"
#include "kernels/vec.h"

namespace aerate {

// A hierarchy over the facets of another one, for the CPU: four boxes, or four facets, are looked at by one vector
// instruction, in fp32 with room for its rounding. What that cannot tell is measured in fp64, so distances are
// exactly those that the other gives, at a third of the time. Read by any number of threads. O(n).
class NearFacets {
 public:
  // `bvh` must outlive this.
  explicit NearFacets(const kernels::TriangleBvhView& bvh);

  const kernels::Facet& facet(std::uint32_t i) const { return bvh_.facets[i]; }

  // As TriangleBvhView::nearer_than: the nearest facet that is nearer than `best`, else that. Of several at the same
  // distance any, but always the same one.
  kernels::NearestFacet nearer_than(Vec3d p, kernels::NearestFacet best) const;

  // Calls visit(facet) for all that are nearer to p than `distance` mm, and for others not much farther.
  template <typename Visit>
  void for_each_near(Vec3d p, double distance, Visit visit) const {
    Search search(*this, p, distance * distance);
    walk(search, std::move(visit));
  }

 private:
  // Of GCC and Clang.
  using Floats = float __attribute__((vector_size(16)));
  using Flags = std::int32_t __attribute__((vector_size(16)));

  struct Boxes {
    Floats lower_x, lower_y, lower_z, upper_x, upper_y, upper_z;
  };
  // Each holds a facet; of no normal where a ball does.
  struct Discs {
    Floats x, y, z, normal_x, normal_y, normal_z, radius;
  };
  // A point, and how near things must be.
  struct Search {
    Search(const NearFacets& facets, Vec3d p, double limit_squared);
    void set_limit(double limit_squared);

    Vec3f p;
    double error;             // of coordinates in fp32, mm
    float limit = 0;          // squared, for boxes
    float limit_of_disc = 0;  // the same with more room, as more is computed
  };
  struct Entry {
    std::uint32_t node;
    float bound;
  };

  static Floats bounds(const Boxes& boxes, const Search& search);
  static Flags may_be_nearer(const Discs& discs, const Search& search);
  template <typename Visit>
  void walk(Search& search, Visit visit) const;
  void set_disc(std::size_t i);

  kernels::TriangleBvhView bvh_;
  double error_ = 0;
  std::uint32_t first_leaf_ = 0;  // nodes level by level: node i has children 4 i + 1 to 4 i + 4
  std::vector<Boxes> boxes_;      // of the children of inner nodes
  std::vector<Discs> discs_;      // by leaf
};

inline NearFacets::Floats NearFacets::bounds(const Boxes& boxes, const Search& search) {
  const auto beyond = [](Floats lower, Floats upper, float p) {
    const Floats below = lower - p, above = p - upper, none{};
    const Floats either = below > above ? below : above;
    return either > none ? either : none;
  };
  const Floats x = beyond(boxes.lower_x, boxes.upper_x, search.p.x);
  const Floats y = beyond(boxes.lower_y, boxes.upper_y, search.p.y);
  const Floats z = beyond(boxes.lower_z, boxes.upper_z, search.p.z);
  return x * x + y * y + z * z;
}

inline NearFacets::Flags NearFacets::may_be_nearer(const Discs& discs, const Search& search) {
  constexpr float kRounding = 4e-6F;  // of sums of a few products, relative to the largest
  const Floats x = search.p.x - discs.x, y = search.p.y - discs.y, z = search.p.z - discs.z;
  const Floats squared = x * x + y * y + z * z;
  const Floats height = discs.normal_x * x + discs.normal_y * y + discs.normal_z * z;
  const Floats rounding = squared * kRounding;
  const Floats reach = discs.radius * discs.radius;
  // The disc is height^2 + (beside - radius)^2 away where the point is not above it.
  const Floats above = height * height, beside = squared - above + rounding;
  const Floats rest = squared - rounding + reach - search.limit_of_disc;
  const Flags is_far =
      (above - rounding > search.limit_of_disc) |
      ((beside > reach + 3 * rounding) & (rest > 0.F) & (rest * rest > 4.0001F * reach * beside));
  return ~is_far;
}

template <typename Visit>
void NearFacets::walk(Search& search, Visit visit) const {
  if (bvh_.facets.size == 0) return;
  std::array<Entry, 64> pending;  // three more for each level
  std::size_t count = 1;
  pending[0] = {0, 0};
  while (count > 0) {
    const Entry entry = pending[--count];
    if (entry.bound > search.limit) continue;
    if (entry.node >= first_leaf_) {
      const std::uint32_t leaf = entry.node - first_leaf_;
      const Flags near = may_be_nearer(discs_[leaf], search);
      for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t facet = 4 * leaf + i;
        if (near[i] != 0 && facet < bvh_.facets.size) visit(facet);
      }
      continue;
    }
    const Floats bound = bounds(boxes_[entry.node], search);
    const std::size_t first = count;
    for (std::uint32_t i = 0; i < 4; ++i) {
      if (!(bound[i] <= search.limit)) continue;
      // The nearest last, to be looked at first.
      std::size_t place = count++;
      for (; place > first && pending[place - 1].bound < bound[i]; --place)
        pending[place] = pending[place - 1];
      pending[place] = {4 * entry.node + 1 + i, bound[i]};
    }
  }
}

}  // namespace aerate
