#include "kernels/adaptive_packing.h"
#include "kernels/pack_on_cuda.h"

namespace aerate::kernels {

template AdaptiveResult pack_on_cuda<AdaptivePacking<BallShape>>(int device, const AdaptiveInput& input);

}  // namespace aerate::kernels
