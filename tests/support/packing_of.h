#pragma once

#include <utility>
#include <vector>

#include "core/packing.h"

namespace aerate::test {

// Spheres with the roofs that they take, as a packing of nothing in particular.
inline Packing packing_of(std::vector<Sphere> spheres, const Roof& roof = {}) {
  Packing packing;
  packing.spheres = std::move(spheres);
  packing.limits.roof = roof;
  return packing;
}

}  // namespace aerate::test
