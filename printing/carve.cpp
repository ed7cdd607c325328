#include "printing/carve.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "printing/void_surface.h"

namespace aerate {
namespace {

std::size_t count_triangles(VoidTemplates& templates, const Packing& packing, double tolerance) {
  Monitor silent;
  std::size_t count = 0;
  for (const VoidTemplate& chosen : templates.choose(packing.spheres, tolerance, silent)) {
    count += chosen.triangle_count();
  }
  return count;
}

}  // namespace

Solid carve_keeping_surface(Mesh outer, const Packing& packing, const CarveOptions& options,
                            Monitor& monitor) {
  monitor.check_interrupted();
  VoidTemplates templates(packing.limits.roof);
  const std::vector<VoidTemplate> chosen = templates.choose(packing.spheres, options.tolerance, monitor);
  monitor.check_interrupted();
  return assemble(std::move(outer), packing, chosen);
}

double most_void_triangles(const Packing& packing, const CarveOptions& options) {
  // Of a ball up to 1.8 times 4.84 radii over the tolerance, and 108 at least (docs/benchmarks.md); the
  // circle of a roof with its cone and top takes more where that is small.
  constexpr double kLeast = 400, kPerRadius = 20;
  double count = 0;
  for (const Sphere& sphere : packing.spheres)
    count += kLeast + kPerRadius * sphere.radius / options.tolerance;
  return count;
}

std::size_t estimate_void_triangles(const Packing& packing, const CarveOptions& options) {
  VoidTemplates templates(packing.limits.roof);
  return count_triangles(templates, packing, options.tolerance);
}

std::optional<double> loosen_tolerance(const Packing& packing, const CarveOptions& options,
                                       std::size_t max_triangles) {
  VoidTemplates templates(packing.limits.roof);
  const auto fits = [&](double tolerance) {
    return count_triangles(templates, packing, tolerance) <= max_triangles;
  };
  // At a tolerance of its radius a void has its coarsest surface. Coarse levels are tried first, so that none
  // is made that is finer than needed.
  double coarse = options.tolerance;
  for (const Sphere& ball : packing.spheres) coarse = std::max(coarse, ball.radius);
  if (!fits(coarse)) return std::nullopt;
  double fine = coarse;
  while (fine > options.tolerance) {
    fine = std::max(options.tolerance, coarse / 2);
    if (!fits(fine)) break;
    coarse = fine;
  }
  if (coarse <= options.tolerance) return options.tolerance;
  // fits(coarse) and not fits(fine)
  while (coarse > 1.01 * fine) {
    const double middle = std::sqrt(coarse * fine);
    (fits(middle) ? coarse : fine) = middle;
  }
  return coarse;
}

}  // namespace aerate
