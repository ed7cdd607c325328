#include "kernels/adaptive_packing.h"
#include "kernels/pack_on_cuda.h"

// A source of its own, so that its kernels are compiled beside those of adaptive_cuda.cu.

namespace aerate::kernels {

template AdaptiveResult pack_on_cuda<AdaptivePacking<RoofedShape>>(int device, const AdaptiveInput& input);

}  // namespace aerate::kernels
