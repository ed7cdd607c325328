#include "printing/carve.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "printing/ball_template.h"

namespace aerate {
namespace {

// The level of each ball of the plan.
std::vector<std::size_t> choose_levels(BallLadder& ladder, const VoidPlan& plan, double tolerance) {
  ladder.prepare(plan.spheres, tolerance);
  std::vector<std::size_t> levels;
  levels.reserve(plan.spheres.size());
  for (const Sphere& ball : plan.spheres) levels.push_back(ladder.level_for(ball, tolerance));
  return levels;
}

std::size_t count_triangles(BallLadder& ladder, const VoidPlan& plan, double tolerance) {
  std::size_t count = 0;
  for (const std::size_t level : choose_levels(ladder, plan, tolerance)) {
    count += ladder[level].triangles.size();
  }
  return count;
}

}  // namespace

Solid carve_keeping_surface(Mesh outer, const VoidPlan& plan, const CarveOptions& options, Monitor& monitor) {
  monitor.check_interrupted();
  BallLadder ladder;
  const std::vector<std::size_t> levels = choose_levels(ladder, plan, options.tolerance);
  monitor.check_interrupted();

  std::vector<const BallTemplate*> templates;
  templates.reserve(levels.size());
  for (const std::size_t level : levels) templates.push_back(&ladder[level]);
  return assemble(std::move(outer), plan.spheres, templates);
}

std::size_t estimate_void_triangles(const VoidPlan& plan, const CarveOptions& options) {
  BallLadder ladder;
  return count_triangles(ladder, plan, options.tolerance);
}

std::optional<double> loosen_tolerance(const VoidPlan& plan, const CarveOptions& options,
                                       std::size_t max_triangles) {
  BallLadder ladder;
  const auto fits = [&](double tolerance) {
    return count_triangles(ladder, plan, tolerance) <= max_triangles;
  };
  // At a tolerance of its radius a ball has its coarsest surface. Coarse levels are tried first, so that none
  // is made that is finer than needed.
  double coarse = options.tolerance;
  for (const Sphere& ball : plan.spheres) coarse = std::max(coarse, ball.radius);
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
