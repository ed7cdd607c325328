#pragma once

#include "kernels/adaptive_packing.h"

namespace aerate::kernels {

// `pack_adaptive` on a CUDA device, for host code. Throws CudaError.
AdaptiveResult pack_adaptive_on_cuda(int device, const AdaptiveInput& input);

}  // namespace aerate::kernels
