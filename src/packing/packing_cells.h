#pragma once

#include "core/device.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "kernels/cell_planes.h"

namespace aerate {

// What belongs to each sphere of a packing: the cells of its power diagram, a half of the packing's gap apart
// from their neighbours on either side (kernels/power_cells.h); roofs are no part of it. In the order of the
// spheres; the result does not depend on the device or the number of threads.
//   box: of the model; cuts the cells
// Throws FailureError if the spheres overlap or are outside of the box, or if the device that was asked for
// fails; InterruptedError.
CellPlanes cells_of(const Packing& packing, const Box3d& box, const DeviceRequest& device, Monitor& monitor);

}  // namespace aerate
