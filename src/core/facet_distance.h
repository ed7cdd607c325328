#pragma once

#include <array>

#include "core/surface_index.h"
#include "kernels/facet.h"

namespace aerate {

// Squared distance of two boxes; 0 where they meet.
double distance_squared(const Box3d& a, const Box3d& b);

// Distance of two triangles, mm; 0 where they meet. fp64.
double distance_between(const kernels::Facet& a, const kernels::Facet& b);

// The least distance of one triangle to others, as far as it is below a limit. fp64.
class FacetDistance {
 public:
  // Of a facet: the normal is not of unit length.
  struct Corners {
    std::array<Vec3d, 3> at;
    Vec3d normal;

    explicit Corners(const kernels::Facet& facet);
  };

  FacetDistance(const kernels::Facet& facet, double limit);

  void look_at(const kernels::Facet& other);

  // The facet is within a ball.
  Vec3d middle() const { return middle_; }
  double reach() const { return reach_; }
  // So far, or the limit.
  double distance() const;
  double squared() const { return squared_; }

 private:
  Corners corners_;
  Vec3d middle_;
  double reach_ = 0;
  double squared_;
};

// The distance of a triangle to a surface if that is less than `limit` mm, else the limit.
double distance_to_surface(const kernels::Facet& facet, const kernels::TriangleBvhView& surface,
                           double limit);

}  // namespace aerate
