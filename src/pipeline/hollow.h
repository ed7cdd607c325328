#pragma once

#include <optional>

#include "core/cells.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/solid.h"
#include "core/surface_index.h"
#include "pipeline/drain.h"
#include "pipeline/options.h"
#include "pipeline/prepare.h"
#include "pipeline/report.h"

namespace aerate {

// The whole job: load, inspect, mend, pack, verify, carve, write beside the target, read back, check, rename.
// The output file appears only if everything holds; what the report says of it was measured on what was read
// back. Throws UsageError, InputError, MeshError, NothingToRemoveError, FailureError, InterruptedError.
HollowReport hollow(const HollowOptions& options, Monitor& monitor);

// A model with its voids, ready to be written in one form or several.
struct HollowedModel {
  PackingRequest request;  // what was packed: without voids that would cost more than they save
  PreparedModel model;
  SurfaceIndex surface;                  // of the model
  Packing packing;                       // the voids that are made, or the spheres whose cells they are
  std::optional<CellVoids> cells;        // what is made of them; absent: voids are the packing's own shapes
  std::optional<DrainedVoids> drainage;  // absent: each is sealed
  CarvedModel carved;
};

// The job's two halves, for who needs several forms. The first writes nothing; the second writes the form
// that `options.output` and `options.modifiers` say, and neither predicts a print nor tells its stages.
HollowedModel carve_model(const HollowOptions& options, Monitor& monitor);
HollowReport write_hollowed(const HollowedModel& hollowed, const HollowOptions& options, Monitor& monitor);

}  // namespace aerate
