#pragma once

#include <span>

#include "core/mesh.h"
#include "kernels/vec.h"
#include "view/picture_request.h"
#include "view/scene.h"

// From where a scene is looked at, and how it is cut.

namespace aerate {

// A plane across an axis of the model, and the side of it from which one looks: what lies before it is cut away.
struct Cut {
  CutAxis axis = CutAxis::y;
  double share = 0.5;             // of the model's extent, from its low end: 0 to 1
  bool looks_along_axis = false;  // or against it

  // At either end nothing is cut away.
  bool is_whole() const { return share <= 0 || share >= 1; }
};

// The usual side for a share: x from the right, y from the front, z from above; at the ends from outside.
Cut cut_at(CutAxis axis, double share);

// A point in the plane of a cut, in coordinates of a view; mm.
struct ViewPoint {
  double x = 0, y = 0;
};

// Coordinates of a view: x to the right, y up, z away from who looks, 0 in the plane of the cut; mm. What is in the plane is
// seen in its true shape. What lies deeper is moved to the right and up, so that the sides of a model show: an oblique
// projection, along whose rays only z changes.
class Camera {
 public:
  // `up`: of the scene
  Camera(const Box3f& box, const Cut& cut, Vec3d up);

  Vec3d to_view(Vec3d p) const {
    const double depth = dot(p, forward_) - depth_;
    return {dot(p, right_) + kSlant * depth, dot(p, up_) + kSlant * depth, depth};
  }
  // Of a direction, without the slant.
  Vec3d turned(Vec3d v) const { return {dot(v, right_), dot(v, up_), dot(v, forward_)}; }
  // Of a place in view coordinates.
  Vec3d to_model(Vec3d p) const {
    return right_ * (p.x - kSlant * p.z) + up_ * (p.y - kSlant * p.z) + forward_ * (p.z + depth_);
  }

 private:
  static constexpr double kSlant = 0.22;

  Vec3d right_{1, 0, 0}, up_{0, 0, 1}, forward_{0, 1, 0};
  double depth_ = 0;
};

// The cut of this axis, or of any, that shows most void: of 31 along each axis. The middle if there are no voids.
Cut cut_with_most_void(const Scene& scene, std::span<const CutAxis> axes);

}  // namespace aerate
