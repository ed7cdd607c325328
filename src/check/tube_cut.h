#pragma once

#include "core/drainage.h"
#include "core/segment_distance.h"

namespace aerate {

// A hole is cut by a prism that ends so many radii beyond the surface.
inline constexpr double kCutBeyond = 1.8;

inline Vec3d axis_of(const Tube& tube) {
  const Vec3d along = tube.end - tube.start;
  return along * (1 / length(along));
}

// The axis of that prism.
inline Segment cut_of(const Tube& tube) {
  return {tube.start, tube.end + axis_of(tube) * (kCutBeyond * tube.radius)};
}

}  // namespace aerate
