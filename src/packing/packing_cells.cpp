#include "packing/packing_cells.h"

#include <stdexcept>
#include <vector>

#include "core/error.h"
#include "kernels/power_cells.h"
#include "packing/run_on_device.h"

namespace aerate {
namespace {

// Seconds for a cell on one thread of a CPU: 20 to 45 us at random places.
WorkEstimate estimate_work(std::size_t spheres) {
  constexpr double kSecondsPerCell = 35e-6;
  constexpr double kFaces = 16;
  const auto count = static_cast<double>(spheres);
  return {count * kSecondsPerCell,
          count * (sizeof(kernels::Ball) + sizeof(Box3d) + kFaces * sizeof(CellPlane))};
}

}  // namespace

CellPlanes cells_of(const Packing& packing, const Box3d& box, const DeviceRequest& device, Monitor& monitor) {
  std::vector<kernels::Ball> balls;
  balls.reserve(packing.spheres.size());
  for (const Sphere& sphere : packing.spheres) balls.push_back({sphere.centre, sphere.radius});
  const auto progress = [&monitor](double share) {
    monitor.progress(share);
    monitor.check_interrupted();
  };
  const kernels::PowerCellsInput input{balls, packing.limits.gap, box, progress};
  try {
    return run_on_device<kernels::PowerCells>(device, estimate_work(balls.size()), monitor, input).result;
  } catch (const std::invalid_argument& error) {
    throw FailureError(error.what());
  }
}

}  // namespace aerate
