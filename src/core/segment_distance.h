#pragma once

#include "kernels/facet.h"
#include "kernels/vec.h"

// Distances of straight pieces, fp64. After C. Ericson, "Real-Time Collision Detection" (2005), section 5.1.

namespace aerate {

struct Segment {
  Vec3d start, end;
};

double distance_between(const Segment& a, const Segment& b);
double distance_to_point(const Segment& segment, Vec3d point);
// 0 where they meet.
double distance_to_facet(const Segment& segment, const kernels::Facet& facet);

}  // namespace aerate
