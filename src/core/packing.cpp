#include "core/packing.h"

#include <numbers>

namespace aerate {

double total_volume(const Packing& packing) {
  double sum_of_cubes = 0;
  for (const Sphere& sphere : packing.spheres) sum_of_cubes += sphere.radius * sphere.radius * sphere.radius;
  return sum_of_cubes * 4.0 / 3.0 * std::numbers::pi;
}

}  // namespace aerate
