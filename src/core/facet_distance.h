#pragma once

#include "core/surface_index.h"
#include "kernels/facet.h"

namespace aerate {

// Squared distance of two boxes; 0 where they meet.
double distance_squared(const Box3d& a, const Box3d& b);

// Distance of two triangles, mm; 0 where they meet. fp64.
double distance_between(const kernels::Facet& a, const kernels::Facet& b);

// The distance of a triangle to a surface if that is less than `limit` mm, else the limit.
double distance_to_surface(const kernels::Facet& facet, const kernels::TriangleBvhView& surface,
                           double limit);

}  // namespace aerate
