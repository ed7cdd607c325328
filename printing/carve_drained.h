#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/drainage.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/solid.h"
#include "printing/carve.h"
#include "printing/cut_holes.h"

namespace aerate {

// Carves balls with the roofs that they take, the channels between them and their escape holes.
//
// Each ball's surface is that of `carve_keeping_surface` with openings where tubes meet it (open_ball.h). So
// is the circle at which its roof begins, above which cone and top are put on (roof_top.h). A
// tube is a prism inscribed in it, so tubes are never wider than planned; at both ends its lines end in the
// openings' rings, so that neighbours share their vertices bit for bit and no boolean of the whole is needed.
// The outer surface comes with the holes cut out of it, for the same balls and plan (cut_holes.h); its
// tolerance is that of all. Throws as `carve_keeping_surface`, and FailureError if a surface cannot be made
// as planned.
DrainedSolid carve_drained(OuterWithHoles outer, std::span<const Sphere> balls, const DrainagePlan& plan,
                           Monitor& monitor);

// The same with the holes still to be cut. Throws FailureError if that fails.
DrainedSolid carve_drained(const Mesh& outer, std::span<const Sphere> balls, const DrainagePlan& plan,
                           const CarveOptions& options, Monitor& monitor);

}  // namespace aerate
