#pragma once

#include "kernels/cuda_device.h"
#include "kernels/packer.h"
#if defined(__CUDACC__)
#include "kernels/exec_cuda.h"
#endif

// For the sources that instantiate a packer for CUDA, and no others: nvcc compiles them where there is one,
// and the C++ compiler where CUDA is left out.

namespace aerate::kernels {

template <typename Packer>
typename Packer::Result pack_on_cuda([[maybe_unused]] int device,
                                     [[maybe_unused]] const typename Packer::Input& input) {
#if defined(__CUDACC__)
  return Packer::pack(CudaExecutor(device), input);
#else
  throw CudaError(CudaError::Kind::no_device, kNoCuda, "run on the CPU");
#endif
}

}  // namespace aerate::kernels
