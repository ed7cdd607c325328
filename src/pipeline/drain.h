#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/cells.h"
#include "core/drainage.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/solid.h"
#include "core/surface_index.h"
#include "packing/plan_drainage.h"
#include "pipeline/options.h"
#include "pipeline/prepare.h"
#include "printing/cut_holes.h"

namespace aerate {

// How the voids of a result drain.
struct DrainedVoids {
  DrainageRequest request;
  DrainagePlan plan;       // channels, holes, pools
  UndrainedVoids dropped;  // voids that were packed and not made

  // Of the holes, those for which there was no place of the usual width.
  std::size_t count_narrow_holes() const;
};

// Some of the voids, by their indices.
Packing with_only(const Packing& packing, std::span<const std::uint32_t> kept);
CellVoids with_only(const CellVoids& cells, std::span<const std::uint32_t> kept);

// The voids that are made. If they drain: how, and the model's surface with the holes cut.
struct DrainedPacking {
  Packing packing;
  std::optional<DrainedVoids> voids;
  OuterWithHoles outer;
};

// If the options ask for it: plans how the voids of a packing drain, and leaves those out that cannot, with a
// notice of how many and why, and of tubes that are wider than `process` bridges. `surface` is the model's.
// Throws what plan_drainage throws.
DrainedPacking drain(const PreparedModel& model, const SurfaceIndex& surface, Packing packing,
                     const ProcessChoice& process, const HollowOptions& options, Monitor& monitor);

// Cells that drain, and what they leave of the model.
struct DrainedCells {
  CellVoids cells;  // those that are made
  DrainedVoids voids;
  Solid solid;
};

// The same for cells, which are joined by windows in the walls between them; carved as well, since that tells
// whether a tube can be cut. Throws what plan_cell_drainage throws.
DrainedCells drain_cells(const PreparedModel& model, const SurfaceIndex& surface, const CellVoids& cells,
                         const PackingLimits& limits, const HollowOptions& options, double tolerance,
                         Monitor& monitor);

// Throws UsageError unless fp32 can hold the sides of tubes anywhere in the model.
void require_resolvable_tubes(const Mesh& model, const DrainageRequest& request, double tolerance);

// Throws UsageError if voids within the limits are too small for the tubes that are asked for.
void require_room_for_tubes(const DrainageRequest& request, const PackingLimits& limits);

// A result, and the tolerance of its void surfaces, mm.
struct CarvedModel {
  Solid solid;
  double tolerance = 0;
};

// Carves voids that drain; their holes were cut at a tolerance that may be this one. Where openings take more
// triangles than were estimated, the tolerance is loosened until they are at most `max_triangles`. Throws as
// carve_drained, and UsageError if there are more at any tolerance.
CarvedModel carve_within(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                         const DrainagePlan& plan, OuterWithHoles outer, double tolerance,
                         std::optional<std::size_t> max_triangles, Monitor& monitor);

}  // namespace aerate
