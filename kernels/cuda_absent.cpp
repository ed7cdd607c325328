#include "kernels/adaptive_cuda.h"
#include "kernels/cuda_device.h"
#include "kernels/hexagonal_cuda.h"

// In place of the CUDA sources where CUDA is left out.

namespace aerate::kernels {

std::string cuda_build() {
  return {};
}

CudaDevices find_cuda_devices() {
  return {{}, "this build has no CUDA"};
}

HexagonalResult pack_hexagonal_on_cuda(int /*device*/, const HexagonalInput& /*input*/) {
  throw CudaError(CudaError::Kind::no_device, "this build has no CUDA", "run on the CPU");
}

AdaptiveResult pack_adaptive_with_roofs_on_cuda(int /*device*/, const AdaptiveInput& /*input*/) {
  throw CudaError(CudaError::Kind::no_device, "this build has no CUDA", "run on the CPU");
}

AdaptiveResult pack_adaptive_on_cuda(int /*device*/, const AdaptiveInput& /*input*/) {
  throw CudaError(CudaError::Kind::no_device, "this build has no CUDA", "run on the CPU");
}

}  // namespace aerate::kernels
