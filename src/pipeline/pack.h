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

// A request for cells with the least radius that suits cells of this model, if that is open; any other as it is.
PackingRequest sized_for(const PreparedModel& model, PackingRequest request, Monitor& monitor);

// Packs a prepared model and verifies the packing. Throws UsageError if memory would not suffice, and
// NothingToRemoveError, naming the largest sphere that would fit, if there is no sphere under these limits.
PackedModel pack_model(const PreparedModel& model, const PackingRequest& request, Monitor& monitor);

// The packing alone, of a model that must be closed: its spheres or its cells, written as `options.output` says. A
// mesh of pieces is read back and checked before it appears. Throws what `hollow` throws.
PackReport pack(const PackOptions& options, Monitor& monitor);

// The same for who has a use for the pieces of cells, too.
struct PackedPieces {
  PackReport report;
  Mesh pieces;  // as it comes out of any file; empty where none were made
};
PackedPieces pack_pieces(const PackOptions& options, Monitor& monitor);

}  // namespace aerate
