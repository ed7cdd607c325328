#include "kernels/adaptive_cuda.h"
#include "kernels/exec_cuda.h"

// A source of its own, so that its kernels are compiled beside those of adaptive_cuda.cu.

namespace aerate::kernels {

AdaptiveResult pack_adaptive_with_roofs_on_cuda(int device, const AdaptiveInput& input) {
  const CudaExecutor executor(device);
  require_room_for_index(executor, input.triangles.size());
  return pack_adaptive_with_roofs(executor, input);
}

}  // namespace aerate::kernels
