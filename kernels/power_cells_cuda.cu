#include "kernels/pack_on_cuda.h"
#include "kernels/power_cells.h"

namespace aerate::kernels {

template CellPlanes pack_on_cuda<PowerCells>(int device, const PowerCellsInput& input);

}  // namespace aerate::kernels
