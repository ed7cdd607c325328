#include "printing/strength.h"

namespace aerate {

double stiffness_upper_bound(double solid_fraction, double poisson_ratio) {
  if (solid_fraction <= 0) return 0;
  const double voids = 1 - solid_fraction;
  // Moduli of the material for a Young's modulus of 1.
  const double bulk = 1 / (3 * (1 - 2 * poisson_ratio));
  const double shear = 1 / (2 * (1 + poisson_ratio));
  const double left_bulk = bulk + voids / (-1 / bulk + 3 * solid_fraction / (3 * bulk + 4 * shear));
  const double left_shear = shear + voids / (-1 / shear + 6 * solid_fraction * (bulk + 2 * shear) /
                                                              (5 * shear * (3 * bulk + 4 * shear)));
  return 9 * left_bulk * left_shear / (3 * left_bulk + left_shear);
}

}  // namespace aerate
