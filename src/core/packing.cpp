#include "core/packing.h"

namespace aerate {

double total_volume(const Packing& packing) {
  return total_volume(packing.spheres, packing.limits.roof);
}

double total_volume(std::span<const Sphere> spheres, const Roof& roof) {
  double sum = 0;
  for (const Sphere& sphere : spheres) sum += void_volume(roof, sphere.radius);
  return sum;
}

}  // namespace aerate
