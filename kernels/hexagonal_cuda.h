#pragma once

#include "kernels/hexagonal.h"

namespace aerate::kernels {

// `pack_hexagonal` on a CUDA device, for host code. Works in slabs of places that fit into the device's free
// memory, and in strips of the model if the index of all triangles does not fit; throws CudaError
// (out_of_memory) if that is not enough, before anything is computed where it can be foreseen.
HexagonalResult pack_hexagonal_on_cuda(int device, const HexagonalInput& input);

}  // namespace aerate::kernels
