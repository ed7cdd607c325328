#pragma once

#include <cstddef>
#include <vector>

#include "core/mesh.h"
#include "kernels/roof.h"
#include "kernels/sphere.h"

// What a roof puts on a triangulated ball that is open along the circle at its shoulder.

namespace aerate {

enum class RoofTop {
  flat,      // a cone, and a flat top
  shoulder,  // a flat top where the ball is cut: the cone would be thinner than rounding
  apex,      // a cone whose top is a point, within the tolerance
};

RoofTop roof_top_of(const Roof& roof, const Sphere& sphere, double tolerance);

// Distance of the void's farthest point from its centre.
double farthest_point(const Roof& roof, double radius);

// `rounding_margin` of a void with its roof.
double void_rounding_margin(const Roof& roof, const Sphere& sphere);

// Vertices are moved towards the centre by this share of their distance, so that every plane that touches the
// void is left behind by the rounding margin at least.
double void_shrinkage(const Roof& roof, const Sphere& sphere);

// Triangles above a ring of `count` vertices from number `first` on, counter-clockwise seen from above. Those
// of the top are numbered from `rim` on: as many for a flat one, one for an apex. They face outward.
std::vector<Triangle> roof_triangles(RoofTop top, std::size_t first, std::size_t count, std::size_t rim);

}  // namespace aerate
