#include "kernels/hexagonal_strips.h"
#include "kernels/pack_on_cuda.h"

namespace aerate::kernels {

template HexagonalResult pack_on_cuda<HexagonalPacking>(int device, const HexagonalInput& input);

}  // namespace aerate::kernels
