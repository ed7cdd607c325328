#pragma once

#include "core/cells.h"
#include "core/device.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "core/surface_index.h"
#include "pipeline/prepare.h"
#include "printing/cells/shape_cells.h"

namespace aerate {

// The cells of a packing of this model as planes, moved in by half the gap. Throws what cells_of throws.
CellPlanes planes_of_cells(const PreparedModel& model, const Packing& packing, const DeviceRequest& device,
                           Monitor& monitor);

// The voids that fill these cells (shape_cells.h), none of whose surfaces runs through itself. `surface` is the
// model's. Throws UsageError for more memory than there is, and what shape_cells throws; NothingToRemoveError if no
// cell is wide enough.
CellVoids shape_sound_cells(const PreparedModel& model, const SurfaceIndex& surface, const Packing& packing,
                            const CellPlanes& planes, const CellShape& shape, Monitor& monitor);

}  // namespace aerate
