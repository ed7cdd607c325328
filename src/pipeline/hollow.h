#pragma once

#include <span>

#include "core/monitor.h"
#include "pipeline/best_form.h"
#include "pipeline/carve_model.h"
#include "pipeline/options.h"
#include "pipeline/report.h"

namespace aerate {

// The whole job: load, inspect, mend, pack, verify, carve, write beside the target, read back, check, rename.
// The output file appears only if everything holds; what the report says of it was measured on what was read
// back. Throws UsageError, InputError, MeshError, NothingToRemoveError, FailureError, InterruptedError.
HollowReport hollow(const HollowOptions& options, Monitor& monitor);

// The same in the best of several forms (pipeline/best_form.h).
HollowReport hollow(std::span<const JobForm> forms, Monitor& monitor);

// Writes a model that was carved in the form that `options.output` and `options.modifiers` say, for who needs several.
// Neither predicts a print nor tells its stages.
HollowReport write_hollowed(const HollowedModel& hollowed, const HollowOptions& options, Monitor& monitor);

}  // namespace aerate
