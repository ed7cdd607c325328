#include "kernels/exec_cuda.h"
#include "kernels/hexagonal_cuda.h"

namespace aerate::kernels {

HexagonalResult pack_hexagonal_on_cuda(int device, const HexagonalInput& input) {
  const CudaExecutor executor(device);
  return pack_hexagonal(executor, input);
}

}  // namespace aerate::kernels
