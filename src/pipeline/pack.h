#pragma once

#include "core/monitor.h"
#include "core/packing.h"
#include "core/surface_index.h"
#include "pipeline/options.h"
#include "pipeline/prepare.h"
#include "pipeline/report.h"

namespace aerate {

// A packing, and the index of the model's surface by which it was verified.
struct PackedModel {
  Packing packing;
  SurfaceIndex surface;
};

// Packs a prepared model and verifies the packing. Throws UsageError if memory would not suffice, and
// NothingToRemoveError, naming the largest sphere that would fit, if there is no sphere under these limits.
PackedModel pack_model(const PreparedModel& model, const PackingRequest& request, Monitor& monitor);

// The packing alone, of a model that must be closed.
PackReport pack(const PackOptions& options, Monitor& monitor);

}  // namespace aerate
