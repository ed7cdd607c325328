#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "kernels/triangle_bvh.h"
#include "kernels/vec.h"

namespace aerate {

// Where rays meet the facets of a hierarchy, for the CPU: four of its boxes are looked at by one vector instruction, in fp32
// with room for its rounding, and the facets that these do not exclude in fp64. Read by any number of threads. O(n).
class RayFacets {
 public:
  // `bvh` must outlive this.
  explicit RayFacets(const kernels::TriangleBvhView& bvh);

  struct Hit {
    double along;         // mm
    std::uint32_t facet;  // in the hierarchy's order
  };

  // The nearest place along a direction (unit) at which a ray meets a facet; nullopt if it is no nearer than `longest`. A ray
  // through an edge may miss both of its triangles.
  std::optional<Hit> first_hit(Vec3d start, Vec3d direction, double longest) const;

  // Whether there is any: at less cost.
  bool is_hit(Vec3d start, Vec3d direction, double longest) const;

 private:
  // Of GCC and Clang.
  using Floats = float __attribute__((vector_size(16)));
  using Flags = std::int32_t __attribute__((vector_size(16)));

  struct Boxes {
    Floats lower_x, lower_y, lower_z, upper_x, upper_y, upper_z;
  };
  // A ray in fp32: its start is somewhere between two points, and it has no direction along which an axis does not change.
  struct Ray;
  struct Entry {
    std::uint32_t node;
    float enters;
  };

  template <typename Visit>
  void walk(const Ray& ray, const double& longest, Visit visit) const;
  void set_box(Boxes& boxes, std::size_t i, const Box3f& box) const;

  kernels::TriangleBvhView bvh_;
  double largest_ = 0;            // of coordinates
  std::uint32_t roots_ = 1;       // level by level: node i has children 4 i + roots to 4 i + roots + 3
  std::uint32_t first_leaf_ = 0;  // from here on the boxes are those of facets
  std::vector<Boxes> boxes_;      // of a node's children, or of a leaf's facets
};

}  // namespace aerate
