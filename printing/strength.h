#pragma once

namespace aerate {

// Poisson's ratio that stiffness is estimated with: of printed plastics and metals, 0.3 to 0.4.
inline constexpr double kPoissonRatio = 0.35;

// Upper bound for Young's modulus of an isotropic solid of which only the share `solid_fraction` is left, the
// rest being voids, relative to that of the whole material: Hashin and Shtrikman, "A variational approach to
// the theory of the elastic behaviour of multiphase materials", J. Mech. Phys. Solids 11 (1963),
// equations 4.1 to 4.4 with one phase empty. Spherical voids of all sizes come nearest to it. Nothing about
// walls, shape or layers goes into it: an estimate.
//   solid_fraction: 0..1; poisson_ratio: of the material, -1 < ratio < 0.5
double stiffness_upper_bound(double solid_fraction, double poisson_ratio = kPoissonRatio);

// Of blocks with skins and sealed voids: the mean Young's modulus along their axes, relative to that bound, as
// finite elements give it (bench/bench_stiffness; docs/cells.md). Skins lie along the load, so it can pass 1;
// the least is 4 % lower than found, which is what finer elements left of it.
struct ShareOfBound {
  double least = 1;
  double most = 1;
};
inline constexpr ShareOfBound kBlocksWithSpheres{0.96, 1.03};
inline constexpr ShareOfBound kBlocksWithCells{0.97, 1.10};

}  // namespace aerate
