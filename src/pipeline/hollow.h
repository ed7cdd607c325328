#pragma once

#include <functional>
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

// The same for who makes more of it: `also` is called with what was made and all that was found out (but for stages and notices)
// before the result takes its place. What it throws leaves no result.
using AlsoMade = std::function<void(const HollowedForm& made, const HollowReport& report, Monitor& monitor)>;
HollowReport hollow(std::span<const JobForm> forms, Monitor& monitor, const AlsoMade& also);

// Writes a model that was carved in the form that `options.output` and `options.modifiers` say, for who needs several.
// Neither predicts a print nor tells its stages.
HollowReport write_hollowed(const HollowedModel& hollowed, const HollowOptions& options, Monitor& monitor);

}  // namespace aerate
