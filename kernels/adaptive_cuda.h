#pragma once

#include <cstddef>

#include "kernels/adaptive_packing.h"

namespace aerate::kernels {

class CudaExecutor;

// `pack_adaptive` on a CUDA device, for host code. What is worked on at a time follows the device's free
// memory; the triangles' index, the cells and the balls must fit. Throws CudaError (out_of_memory) if they do
// not, for the index before anything is allocated.
AdaptiveResult pack_adaptive_on_cuda(int device, const AdaptiveInput& input);

// The same for `pack_adaptive_with_roofs`.
AdaptiveResult pack_adaptive_with_roofs_on_cuda(int device, const AdaptiveInput& input);

// Throws CudaError (out_of_memory) unless the index of so many triangles fits into the memory that is free.
void require_room_for_index(const CudaExecutor& executor, std::size_t triangle_count);

}  // namespace aerate::kernels
