#pragma once

#include <vector>

#include "kernels/roof.h"
#include "kernels/sphere.h"

namespace aerate {

// The solids to remove from a model, millimetres in its own coordinates: pairwise disjoint balls, each with
// the roof that its radius takes, wholly inside the model where its winding number is 1.
struct VoidPlan {
  std::vector<Sphere> spheres;
  Roof roof = {};
};

}  // namespace aerate
