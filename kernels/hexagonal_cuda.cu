#include <string>

#include "kernels/exec_cuda.h"
#include "kernels/hexagonal_cuda.h"

namespace aerate::kernels {

HexagonalResult pack_hexagonal_on_cuda(int device, const HexagonalInput& input) {
  const CudaExecutor executor(device);
  const std::size_t least = least_index_bytes(input);
  const std::size_t free = executor.free_bytes();
  if (free < least) {
    throw CudaError(CudaError::Kind::out_of_memory,
                    "the index of " + std::to_string(input.triangles.size()) + " triangles needs more than " +
                        std::to_string(least >> 10) + " KiB of device memory, and " +
                        std::to_string(free >> 10) + " KiB are free",
                    "close other programs that use the device, or run on the CPU");
  }
  return pack_hexagonal(executor, input);
}

}  // namespace aerate::kernels
