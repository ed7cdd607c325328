#pragma once

#include "kernels/annotations.h"
#include "kernels/roof.h"

namespace aerate::kernels {

// What the voids of a packing are shaped like, as a template argument: balls do not pay for roofs that they
// do not have.
struct BallShape {
  static constexpr bool kHasRoof = false;
};

struct RoofedShape {
  static constexpr bool kHasRoof = true;
  Roof roof;

  // The most that a void of this radius lies nearer to something than its ball does.
  AERATE_HD double head_start(double radius) const { return (1 - roof.sine) * roof.spine(radius); }
};

}  // namespace aerate::kernels
