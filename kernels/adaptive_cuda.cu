#include "kernels/adaptive_cuda.h"
#include "kernels/exec_cuda.h"

namespace aerate::kernels {

AdaptiveResult pack_adaptive_on_cuda(int device, const AdaptiveInput& input) {
  const CudaExecutor executor(device);
  return pack_adaptive(executor, input);
}

}  // namespace aerate::kernels
