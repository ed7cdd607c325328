#pragma once

#include "core/monitor.h"
#include "pipeline/options.h"
#include "pipeline/report.h"

namespace aerate {

// The whole job: load, inspect, mend, pack, verify, carve, write beside the target, read back, check, rename.
// The output file appears only if everything holds; what the report says of it was measured on what was read
// back. Throws UsageError, InputError, MeshError, NothingToRemoveError, FailureError, InterruptedError.
HollowReport hollow(const HollowOptions& options, Monitor& monitor);

}  // namespace aerate
