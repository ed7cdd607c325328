#pragma once

#include <vector>

#include "kernels/sphere.h"

namespace aerate {

// The solids to remove from a model, millimetres in its own coordinates: pairwise disjoint balls, each wholly
// inside the model where its winding number is 1.
struct VoidPlan {
  std::vector<Sphere> spheres;
};

}  // namespace aerate
