#pragma once

#include <algorithm>
#include <cmath>

#include "kernels/facet.h"
#include "kernels/point_triangle.h"
#include "kernels/roof.h"
#include "kernels/roof_distance.h"
#include "kernels/sphere.h"

namespace aerate {

// The planned shape of a void, as the bound that its surface must keep.
class PlannedShape {
 public:
  PlannedShape(const Roof& roof, const Sphere& planned)
      : roof_(roof), planned_(planned), has_roof_(roof.shapes(planned.radius)) {}

  // Takes a vertex in.
  void hold(Vec3f p) {
    const Vec3d offset = to_double(p) - planned_.centre;
    farthest_squared_ = std::max(farthest_squared_, length_squared(offset));
    if (has_roof_) radius_ = std::max(radius_, least_radius_holding(roof_, planned_.centre, to_double(p)));
  }
  // The least radius whose void holds all that were taken in.
  double radius() const {
    return has_roof_ && roof_.shapes(radius_) ? radius_ : std::sqrt(farthest_squared_);
  }

  // How deep inside the shape a facet lies at its deepest; where there is a roof, at most.
  double depth(const kernels::Facet& facet) const {
    if (!has_roof_)
      return planned_.radius - std::sqrt(kernels::distance_squared_to_facet(planned_.centre, facet));
    const double lowest =
        std::min({height(facet.a), height(facet.b), height(facet.c)});  // which is below the flat top
    return std::min(roof_.top(planned_.radius) - lowest,
                    kernels::lateral_depth(roof_, planned_.centre, planned_.radius, facet));
  }

  double volume() const { return void_volume(roof_, planned_.radius); }
  // Of what is left where the surface is `tolerance` inside: no less than the shape scaled about its centre,
  // which is that far from its nearest side.
  double volume_within(double tolerance) const {
    const double nearest = std::min(planned_.radius, roof_.top(planned_.radius));
    const double scale = std::max(0.0, 1 - tolerance / nearest);
    return volume() * scale * scale * scale;
  }

 private:
  double height(Vec3f p) const { return dot(to_double(p) - planned_.centre, roof_.up); }

  const Roof& roof_;
  const Sphere& planned_;
  bool has_roof_;
  double farthest_squared_ = 0;
  double radius_ = 0;
};

}  // namespace aerate
