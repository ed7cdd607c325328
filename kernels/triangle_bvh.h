#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "kernels/constants.h"
#include "kernels/facet.h"
#include "kernels/point_triangle.h"
#include "kernels/space_curve.h"
#include "kernels/vec.h"
#include "kernels/view.h"

// Exact (fp64) nearest points on a triangle mesh, from an implicit bounding-volume hierarchy: facets in the
// order of a Hilbert curve, `kLeafFacets` of them to a leaf, and a complete binary tree over the leaves whose
// boxes are computed level by level. There are no pointers: node i has children 2i and 2i+1, the root is 1.
// The walk keeps its way back in the bits of one word (after A. Afra and L. Szirmay-Kalos, "Stackless
// multi-BVH traversal for CPU, MIC and GPU ray tracing", 2014), so it needs neither recursion nor a stack.

namespace aerate::kernels {

AERATE_HD inline int count_trailing_zeros(std::uint64_t bits) {
#if defined(__CUDA_ARCH__)
  return __ffsll(static_cast<long long>(bits)) - 1;
#else
  return __builtin_ctzll(bits);
#endif
}

// Squared distance from p to a box; infinite for an empty box (lower = +inf). The box holds fp32 positions as
// they are, so nothing is lost by its precision.
AERATE_HD inline double distance_squared_to_box(Vec3d p, const Box3f& box) {
  const Vec3d lower = to_double(box.lower);
  const Vec3d upper = to_double(box.upper);
  const double x = max_of(max_of(lower.x - p.x, p.x - upper.x), 0.0);
  const double y = max_of(max_of(lower.y - p.y, p.y - upper.y), 0.0);
  const double z = max_of(max_of(lower.z - p.z, p.z - upper.z), 0.0);
  return x * x + y * y + z * z;
}

struct NearestFacet {
  double distance_squared;  // the limit if there is none within it
  std::uint32_t facet;      // position in the hierarchy's own order, or kNone
};

struct TriangleBvhView {
  static constexpr std::uint32_t kLeafFacets = 4;

  View<const Facet> facets;         // in the hierarchy's order
  View<const std::uint32_t> order;  // order[i]: index in the mesh of facets[i]
  View<const Box3f> boxes;          // by node; boxes[0] is not used
  std::uint32_t first_leaf = 1;     // a power of two; leaf node n holds facets from (n - first_leaf) * 4

  // Nearest facet closer than sqrt(limit_squared), which may be infinite. Of several at the same distance the
  // one that the walk meets first, which depends on p and the mesh only.
  AERATE_HD NearestFacet nearest(Vec3d p, double limit_squared) const {
    return nearer_than(p, {limit_squared, kNone});
  }

  // The same where some facet and its distance are known already: `best` if no facet is nearer.
  AERATE_HD NearestFacet nearer_than(Vec3d p, NearestFacet best) const {
    DistanceMetric metric{p, best, facets};
    walk(metric);
    return metric.best;
  }

  // The walk itself, for any measure of nearness: `metric.bound(box)` is at most what the metric makes of
  // each facet in the box, `metric.visit(i)` looks at a facet, `metric.limit()` is the least value so far.
  template <typename Metric>
  AERATE_HD void walk(Metric& metric) const {
    std::uint32_t node = 1;
    // Bit k: the sibling of the ancestor k levels up is still to be visited.
    std::uint64_t pending = 0;
    while (true) {
      bool descend = false;
      if (node < first_leaf) {
        const double left = metric.bound(boxes[2 * node]);
        const double right = metric.bound(boxes[2 * node + 1]);
        const bool right_first = right < left;
        if ((right_first ? right : left) < metric.limit()) {
          const bool both = (right_first ? left : right) < metric.limit();
          pending = (pending << 1) | (both ? 1u : 0u);
          node = 2 * node + (right_first ? 1 : 0);
          descend = true;
        }
      } else {
        const std::uint32_t first = (node - first_leaf) * kLeafFacets;
        const std::uint32_t last = min_of(first + kLeafFacets, static_cast<std::uint32_t>(facets.size));
        for (std::uint32_t i = first; i < last; ++i) metric.visit(i);
      }
      while (!descend) {
        if (pending == 0) return;
        const int levels = count_trailing_zeros(pending);
        node = (node >> levels) ^ 1u;
        pending = (pending >> levels) & ~std::uint64_t{1};
        descend = metric.bound(boxes[node]) < metric.limit();
      }
    }
  }

 private:
  struct DistanceMetric {
    Vec3d p;
    NearestFacet best;
    View<const Facet> facets;

    AERATE_HD double bound(const Box3f& box) const { return distance_squared_to_box(p, box); }
    AERATE_HD double limit() const { return best.distance_squared; }
    AERATE_HD void visit(std::uint32_t i) {
      // Most facets of a leaf are farther than the best so far, as their boxes tell at a fifth of the cost.
      if (bound(box_of(facets[i])) >= best.distance_squared) return;
      const double distance_squared = distance_squared_to_facet(p, facets[i]);
      if (distance_squared < best.distance_squared) best = {distance_squared, i};
    }
  };
};

namespace triangle_bvh_detail {

struct CurveKeys {
  View<const Facet> facets;
  CurveFrame frame;
  View<std::uint64_t> keys;
  View<std::uint32_t> order;

  AERATE_HD void operator()(std::size_t i) const {
    const Facet& f = facets[i];
    keys[i] = frame.key((to_double(f.a) + to_double(f.b) + to_double(f.c)) * (1.0 / 3.0));
    order[i] = static_cast<std::uint32_t>(i);
  }
};

struct Reorder {
  View<const Facet> from;
  View<const std::uint32_t> order;
  View<Facet> to;

  AERATE_HD void operator()(std::size_t i) const { to[i] = from[order[i]]; }
};

struct LeafBoxes {
  View<const Facet> facets;
  View<Box3f> boxes;
  std::uint32_t first_leaf;

  AERATE_HD void operator()(std::size_t leaf) const {
    Box3f box = empty_box();
    const std::size_t first = leaf * TriangleBvhView::kLeafFacets;
    const std::size_t last = min_of(first + TriangleBvhView::kLeafFacets, facets.size);
    for (std::size_t i = first; i < last; ++i) box = united(box, box_of(facets[i]));
    boxes[first_leaf + leaf] = box;
  }
};

struct InnerBoxes {
  View<Box3f> boxes;
  std::uint32_t first_node;

  AERATE_HD void operator()(std::size_t i) const {
    const std::size_t node = first_node + i;
    boxes[node] = united(boxes[2 * node], boxes[2 * node + 1]);
  }
};

}  // namespace triangle_bvh_detail

template <typename Executor>
struct TriangleBvh {
  typename Executor::template Buffer<Facet> facets;
  typename Executor::template Buffer<std::uint32_t> order;
  typename Executor::template Buffer<Box3f> boxes;
  TriangleBvhView view;

  std::size_t bytes() const {
    return facets.size() * (sizeof(Facet) + sizeof(std::uint32_t)) + boxes.size() * sizeof(Box3f);
  }
};

// Builds the hierarchy over facets whose positions lie in `box`; it keeps its own copy of them. O(n log n),
// about 60 bytes for each facet.
template <typename Executor>
TriangleBvh<Executor> build_triangle_bvh(const Executor& executor, View<const Facet> facets,
                                         const Box3d& box) {
  TriangleBvh<Executor> bvh;
  auto keys = executor.template allocate<std::uint64_t>(facets.size);
  bvh.order = executor.template allocate<std::uint32_t>(facets.size);
  executor.for_each_index(
      facets.size, triangle_bvh_detail::CurveKeys{facets, CurveFrame(box), keys.view(), bvh.order.view()});
  executor.sort_pairs(keys.view(), bvh.order.view());
  bvh.facets = executor.template allocate<Facet>(facets.size);
  executor.for_each_index(facets.size,
                          triangle_bvh_detail::Reorder{facets, bvh.order.view(), bvh.facets.view()});

  const std::size_t used_leaves =
      (facets.size + TriangleBvhView::kLeafFacets - 1) / TriangleBvhView::kLeafFacets;
  std::uint32_t leaves = 1;
  while (leaves < used_leaves) leaves *= 2;
  bvh.boxes = executor.template allocate<Box3f>(2 * std::size_t{leaves});
  executor.for_each_index(leaves,
                          triangle_bvh_detail::LeafBoxes{bvh.facets.view(), bvh.boxes.view(), leaves});
  for (std::uint32_t first = leaves / 2; first >= 1; first /= 2) {
    executor.for_each_index(first, triangle_bvh_detail::InnerBoxes{bvh.boxes.view(), first});
  }
  bvh.view = {bvh.facets.view(), bvh.order.view(), bvh.boxes.view(), leaves};
  return bvh;
}

// Exact distances from points to one mesh, on all CPU threads, for host code.
class HostTriangleBvh {
 public:
  HostTriangleBvh(std::span<const Vec3f> positions, std::span<const std::array<std::uint32_t, 3>> triangles);
  ~HostTriangleBvh();
  HostTriangleBvh(HostTriangleBvh&&) noexcept;
  HostTriangleBvh& operator=(HostTriangleBvh&&) noexcept;

  // For use in the caller's own loops; valid while this object lives.
  const TriangleBvhView& view() const;
  std::vector<double> distances(std::span<const Vec3d> points) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aerate::kernels
