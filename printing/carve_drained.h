#pragma once

#include "core/drainage.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/packing.h"
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
// The outer surface comes with the holes cut out of it, for the same packing and plan (cut_holes.h); its
// tolerance is that of all. Throws as `carve_keeping_surface`, and FailureError if a surface cannot be made
// as planned.
Solid carve_drained(OuterWithHoles outer, const Packing& packing, const DrainagePlan& plan, Monitor& monitor);

// The same with the holes still to be cut out of a surface, given with its index. Throws FailureError if that
// fails.
Solid carve_drained(const Mesh& outer, const SurfaceIndex& surface, const Packing& packing,
                    const DrainagePlan& plan, const CarveOptions& options, Monitor& monitor);

}  // namespace aerate
