#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "kernels/vec.h"

namespace aerate::kernels {

// A model that is to be packed, in host memory, and whom to tell of progress.
struct PackerInput {
  std::span<const Vec3f> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;
  Box3d box{};  // of the positions
  // Called between pieces of work with the share that is done; what it throws ends the job.
  std::function<void(double)> progress = [](double) {};
};

// A packer is a struct with an Input, which is a PackerInput, a Result, and
//   template <typename Executor> static Result pack(const Executor&, const Input&)
// This is `pack` on a CUDA device. A .cu beside the packer instantiates it (kernels/pack_on_cuda.h).
//   device: CUDA's index
// Throws CudaError; out_of_memory where it can be foreseen, before anything is computed.
template <typename Packer>
typename Packer::Result pack_on_cuda(int device, const typename Packer::Input& input);

}  // namespace aerate::kernels
