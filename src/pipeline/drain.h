#pragma once

#include <cstddef>
#include <optional>

#include "check/drainage_facts.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/solid.h"
#include "core/surface_index.h"
#include "pipeline/options.h"
#include "pipeline/prepare.h"
#include "printing/cut_holes.h"

namespace aerate {

// How voids drain, and the model's surface with its holes cut.
struct PlannedHoles {
  DrainageFacts drainage;
  OuterWithHoles outer;
};

// Plans how the voids of a packing drain, and takes those out of it that cannot, with a notice of how many
// and why. `surface` is the model's, `tolerance` is that of the void surfaces, mm. Throws what plan_drainage
// throws.
PlannedHoles drain_packing(const PreparedModel& model, const SurfaceIndex& surface, Packing& packing,
                           const DrainageRequest& request, double tolerance, Monitor& monitor);

// Throws UsageError if voids within the limits are too small for the tubes that are asked for.
void require_room_for_tubes(const DrainageRequest& request, const PackingLimits& limits);

// What the user should know about channels and escape holes that are wider than the printer bridges, if it
// limits ceilings.
void warn_of_wide_tubes(const ProcessChoice& choice, const Roof& roof, const DrainageRequest& request,
                        Monitor& monitor);

// Carves what was planned; `outer` has the holes, cut at a tolerance that may be this one. Where openings
// take more triangles than were estimated, the tolerance is loosened until they are at most `max_triangles`;
// it is set to what was used. Throws as carve_drained, and UsageError if there are more at any tolerance.
DrainedSolid carve_within(const PreparedModel& model, OuterWithHoles outer, const Packing& packing,
                          const DrainagePlan& plan, double& tolerance,
                          std::optional<std::size_t> max_triangles, Monitor& monitor);

// The drained model as one surface.
Solid as_solid(const DrainedSolid& drained);

}  // namespace aerate
