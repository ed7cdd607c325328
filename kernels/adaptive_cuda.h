#pragma once

#include "kernels/adaptive_packing.h"

namespace aerate::kernels {

// `pack_adaptive` on a CUDA device, for host code. What is worked on at a time follows the device's free
// memory; the triangles' index, the cells and the balls must fit. Throws CudaError (out_of_memory) if they do
// not, for the index before anything is allocated.
AdaptiveResult pack_adaptive_on_cuda(int device, const AdaptiveInput& input);

}  // namespace aerate::kernels
