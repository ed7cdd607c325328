#pragma once

#include <optional>

#include "core/cells.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/surface_index.h"
#include "pipeline/drain.h"
#include "pipeline/options.h"
#include "pipeline/prepare.h"

namespace aerate {

// The cells of a packing, shaped and taken out of the model.
struct CarvedCells {
  CellVoids cells;                       // those that are made
  std::optional<DrainedVoids> drainage;  // absent: each is sealed
  CarvedModel carved;
};

// Shapes the cells of a verified packing as `options.cells` says, drained if the options ask for it, at a coarser tolerance than asked for where they
// would take more triangles than are allowed, and leaves no surface that runs through itself. `surface` is the
// model's. Throws UsageError for more memory or triangles than there may be, and what shape_cells throws;
// NothingToRemoveError if no cell is wide enough.
CarvedCells carve_as_cells(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                           const HollowOptions& options, Monitor& monitor);

// Some of these cells by themselves, at a tolerance at which they were shaped. Throws as drain_cells.
CarvedCells carve_some_cells(const PreparedModel& model, const SurfaceIndex& surface, CellVoids cells,
                             const PackingLimits& limits, const HollowOptions& options, double tolerance,
                             Monitor& monitor);

}  // namespace aerate
