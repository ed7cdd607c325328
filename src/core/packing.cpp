#include "core/packing.h"

namespace aerate {

double total_volume(const Packing& packing) {
  double sum = 0;
  for (const Sphere& sphere : packing.spheres) sum += void_volume(packing.limits.roof, sphere.radius);
  return sum;
}

}  // namespace aerate
