#pragma once

#include <cstddef>

#include "core/drainage.h"
#include "packing/plan_drainage.h"

namespace aerate {

// How the voids of a result drain.
struct DrainageFacts {
  DrainageRequest request;
  DrainagePlan plan;       // channels, holes, pools
  UndrainedVoids dropped;  // voids that were packed and not made

  // Measured on the written file.
  std::size_t sealed_cavities = 0;    // inner surfaces that no way joins to the outside
  std::size_t cavities_of_model = 0;  // inward shells that the model has itself, left as they are
  std::size_t cut_triangles = 0;      // of the model's, where holes come out; all others are as they were
  double channel_wall = 0;            // lower bound of what is between channels and the surface, mm
};

}  // namespace aerate
