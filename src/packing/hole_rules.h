#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/drainage.h"
#include "core/packing.h"
#include "kernels/winding.h"
#include "packing/tube_clearance.h"

// What is asked of every escape hole, and what makes one better than another: the same for spheres and cells.

namespace aerate {

// No hole is longer than this, mm.
double longest_hole(const DrainageRequest& request, const PackingLimits& limits);

// Near its outer end a tube is nearer to the surface than the wall. It comes up to it no flatter than this:
// the sine of 30 degrees.
inline constexpr double kLeastSlope = 0.5;

// Is there room beyond its end, as wide as the hole, outside of every shell? `outward`: see DrainableModel.
bool leads_outside(const Tube& tube, double wall, const TubeClearance& clearance,
                   const kernels::WindingView& outward);

// Weight of what makes a place good beside its height and DrainageRequest::worth_of_hiding.
inline constexpr double kLengthWeight = 0.2;  // a millimetre of tube for each millimetre of height

// Directions in which holes are looked for: spread evenly over the half of the unit sphere about `axis`, which
// is the first of them.
std::vector<Vec3d> directions_about(Vec3d axis);

// The point of the surface nearest to where a hole was asked for. Throws UsageError if that is farther away
// than `within` mm.
Vec3d on_surface_near(Vec3d place, double within, const TubeClearance& clearance,
                      const kernels::WindingView& outward);

// The nearest point of the surface round a place, no farther than two holes are long, at which a hole `opens`; of
// points that are looked at all round, so there may be one a little nearer. In whole hundredths of a millimetre, as
// it is told.
std::optional<Vec3d> nearest_place(Vec3d place, double longest, const TubeClearance& clearance,
                                   const std::function<bool(Vec3d place)>& opens);

}  // namespace aerate
