#pragma once

#include "kernels/hexagonal.h"

namespace aerate::kernels {

// `pack_hexagonal` on a CUDA device, for host code. Works in slabs of places that fit into the device's free
// memory; throws CudaError (out_of_memory) before anything is computed if the triangles' index does not.
HexagonalResult pack_hexagonal_on_cuda(int device, const HexagonalInput& input);

}  // namespace aerate::kernels
