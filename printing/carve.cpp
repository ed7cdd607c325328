#include "printing/carve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tbb/parallel_for.h>
#include <vector>

#include "core/error.h"
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

  Solid solid;
  solid.outer_triangle_count = outer.triangles.size();
  solid.outer_vertex_count = outer.positions.size();
  solid.void_shells.reserve(levels.size());
  ShellRange range{solid.outer_triangle_count, 0, solid.outer_vertex_count, 0};
  for (const std::size_t level : levels) {
    range.triangle_count = ladder[level].triangles.size();
    range.vertex_count = ladder[level].directions.size();
    solid.void_shells.push_back(range);
    range.first_triangle += range.triangle_count;
    range.first_vertex += range.vertex_count;
  }
  if (range.first_vertex > std::numeric_limits<std::uint32_t>::max()) {
    throw FailureError("the voids would take " + std::to_string(range.first_triangle) + " triangles",
                       "raise --tolerance, or set --max-triangles");
  }

  solid.mesh = std::move(outer);
  solid.mesh.positions.resize(range.first_vertex);
  solid.mesh.triangles.resize(range.first_triangle);
  tbb::parallel_for(std::size_t{0}, levels.size(), [&](std::size_t i) {
    const ShellRange& shell = solid.void_shells[i];
    place_void(ladder[levels[i]], plan.spheres[i],
               {std::span(solid.mesh.positions).subspan(shell.first_vertex, shell.vertex_count),
                std::span(solid.mesh.triangles).subspan(shell.first_triangle, shell.triangle_count),
                static_cast<std::uint32_t>(shell.first_vertex)});
  });
  return solid;
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
