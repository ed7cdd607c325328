#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/drainage.h"
#include "core/facets_near.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/solid.h"
#include "printing/carve.h"

namespace aerate {

// A tube that leaves a model, and the ball that it comes out of.
struct WayOut {
  Tube tube;
  Sphere ball;
};

// Can the surface be cut where a tube leaves the model, after it has been cut for others? See `cut_surface`.
bool can_cut(const FacetsNear& outer, const WayOut& way, std::span<const WayOut> others, const Roof& roof,
             double tolerance);

// Carves balls with the roofs that they take, the channels between them and their escape holes.
//
// Each ball's surface is that of `carve_keeping_surface` with openings where tubes meet it (open_ball.h). So
// is the circle at which its roof begins, above which cone and top are put on (roof_top.h). A
// tube is a prism inscribed in it, so tubes are never wider than planned; at both ends its lines end in the
// openings' rings, so that neighbours share their vertices bit for bit and no boolean of the whole is needed.
// The outer surface is cut around the escape holes alone (cut_surface.h); all other triangles keep their
// order. Throws as `carve_keeping_surface`, and FailureError if a surface cannot be made as planned.
DrainedSolid carve_drained(const Mesh& outer, std::span<const Sphere> balls, const DrainagePlan& plan,
                           const CarveOptions& options, Monitor& monitor);

}  // namespace aerate
