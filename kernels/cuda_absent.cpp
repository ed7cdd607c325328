#include "kernels/cuda_device.h"

// In place of the CUDA executor where CUDA is left out.

namespace aerate::kernels {

std::string cuda_build() {
  return {};
}

CudaDevices find_cuda_devices() {
  return {{}, kNoCuda};
}

}  // namespace aerate::kernels
