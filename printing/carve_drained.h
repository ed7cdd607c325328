#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/drainage.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "core/solid.h"
#include "core/surface_index.h"
#include "printing/carve.h"

namespace aerate {

// A tube that leaves a model, and the ball that it comes out of.
struct WayOut {
  Tube tube;
  Sphere ball;
};

// Where a tube leaves the model, does its surface, given with its index, look as if it could be cut? Quick:
// see cut_surface.h.
bool may_be_cut(const Mesh& outer, const SurfaceIndex& surface, const WayOut& way, const Roof& roof,
                double tolerance);

// The first escape hole of a plan for which the surface cannot be cut, after it was cut for those before it.
std::optional<std::size_t> first_uncut_hole(const Mesh& outer, std::span<const Sphere> balls,
                                            const DrainagePlan& plan, const CarveOptions& options,
                                            Monitor& monitor);

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
