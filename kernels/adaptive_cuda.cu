#include <string>

#include "kernels/adaptive_cuda.h"
#include "kernels/exec_cuda.h"

namespace aerate::kernels {

void require_room_for_index(const CudaExecutor& executor, std::size_t triangle_count) {
  constexpr std::size_t kBeside = 1 << 16;
  const std::size_t needed = triangle_count * kAdaptiveIndexBytes + kBeside;
  const std::size_t free = executor.free_bytes();
  if (free >= needed) return;
  throw CudaError(CudaError::Kind::out_of_memory,
                  "the index of " + std::to_string(triangle_count) + " triangles needs about " +
                      std::to_string(needed >> 10) + " KiB of device memory, and " +
                      std::to_string(free >> 10) + " KiB are free",
                  kTooLittleMemoryHint);
}

AdaptiveResult pack_adaptive_on_cuda(int device, const AdaptiveInput& input) {
  const CudaExecutor executor(device);
  require_room_for_index(executor, input.triangles.size());
  return pack_adaptive(executor, input);
}

}  // namespace aerate::kernels
