#include <string>

#include "kernels/adaptive_cuda.h"
#include "kernels/exec_cuda.h"

namespace aerate::kernels {

AdaptiveResult pack_adaptive_on_cuda(int device, const AdaptiveInput& input) {
  const CudaExecutor executor(device);
  constexpr std::size_t kBeside = 1 << 16;
  const std::size_t needed = input.triangles.size() * kAdaptiveIndexBytes + kBeside;
  const std::size_t free = executor.free_bytes();
  if (free < needed) {
    throw CudaError(CudaError::Kind::out_of_memory,
                    "the index of " + std::to_string(input.triangles.size()) + " triangles needs about " +
                        std::to_string(needed >> 10) + " KiB of device memory, and " +
                        std::to_string(free >> 10) + " KiB are free",
                    kTooLittleMemoryHint);
  }
  return pack_adaptive(executor, input);
}

}  // namespace aerate::kernels
