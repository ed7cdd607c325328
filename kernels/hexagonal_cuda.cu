#include <string>

#include "kernels/exec_cuda.h"
#include "kernels/hexagonal_cuda.h"
#include "kernels/hexagonal_strips.h"

namespace aerate::kernels {
namespace {

// As few strips as seem to fit, by powers of two; 0 if even single rows do not.
std::uint32_t strips_for(const HexagonalInput& input, std::uint32_t rows, std::size_t free_bytes) {
  const std::size_t usable = free_bytes / 10 * 9;
  for (std::uint64_t strips = 1;; strips *= 2) {
    const auto tried = static_cast<std::uint32_t>(min_of(strips, std::uint64_t{rows}));
    if (hexagonal_index_bytes(input, tried) <= usable) return tried;
    if (tried == rows) return 0;
  }
}

HexagonalResult pack(const CudaExecutor& executor, const HexagonalInput& input, std::uint32_t strips) {
  return strips == 1 ? pack_hexagonal(executor, input) : pack_hexagonal_in_strips(executor, input, strips);
}

}  // namespace

HexagonalResult pack_hexagonal_on_cuda(int device, const HexagonalInput& input) {
  const CudaExecutor executor(device);
  const std::uint32_t rows = make_hexagonal_lattice(input.box, input.parameters.lattice_radius).count_y;
  const std::size_t free = executor.free_bytes();
  std::uint32_t strips = strips_for(input, max_of(rows, 1u), free);
  if (strips == 0) {
    throw CudaError(CudaError::Kind::out_of_memory,
                    "packing needs about " +
                        std::to_string((hexagonal_index_bytes(input, max_of(rows, 1u)) >> 10) + 1) +
                        " KiB of device memory even in the thinnest strips of the model, and " +
                        std::to_string(free >> 10) + " KiB are free",
                    kTooLittleMemoryHint);
  }
  while (true) {
    try {
      return pack(executor, input, strips);
    } catch (const CudaError& error) {
      // The estimate was too low, or another program was quicker.
      if (error.kind() != CudaError::Kind::out_of_memory || strips >= rows) throw;
      strips = min_of(strips * 2, rows);
    }
  }
}

}  // namespace aerate::kernels
