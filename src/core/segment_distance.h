#pragma once

#include "kernels/facet.h"
#include "kernels/roof.h"
#include "kernels/sphere.h"
#include "kernels/vec.h"

// Distances of straight pieces, fp64. After C. Ericson, "Real-Time Collision Detection" (2005), section 5.1.

namespace aerate {

struct Segment {
  Vec3d start, end;
};

double distance_between(const Segment& a, const Segment& b);
double distance_to_point(const Segment& segment, Vec3d point);
// To a void with the roof that its radius takes, or rather the room that is kept for it (kernels/roof.h);
// negative where they overlap. To 1e-9 of the spine's length.
double distance_to_void(const Segment& segment, const Roof& roof, const Sphere& planned);
// 0 where they meet.
double distance_to_facet(const Segment& segment, const kernels::Facet& facet);

}  // namespace aerate
