#include "kernels/cuda_device.h"

// In place of the CUDA sources where CUDA is left out.

namespace aerate::kernels {

std::string cuda_build() {
  return {};
}

CudaDevices find_cuda_devices() {
  return {{}, "this build has no CUDA"};
}

}  // namespace aerate::kernels
