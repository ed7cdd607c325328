#pragma once

#include "core/monitor.h"
#include "core/packing.h"
#include "pipeline/options.h"
#include "pipeline/prepare.h"
#include "pipeline/report.h"

namespace aerate {

// Packs a prepared model and verifies the packing. Throws UsageError if memory would not suffice, and
// NothingToRemoveError, naming the largest sphere that would fit, if there is no sphere under these limits.
Packing pack_model(const PreparedModel& model, const PackingRequest& request, Monitor& monitor);

// The packing alone, of a model that must be closed.
PackReport pack(const PackOptions& options, Monitor& monitor);

}  // namespace aerate
