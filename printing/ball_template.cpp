#include "printing/ball_template.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <tbb/parallel_for.h>

#include "core/error.h"
#include "printing/level_set.h"
#include "printing/rounding.h"
#include "printing/star_triangulation.h"

namespace aerate {
namespace {

// A ladder of level sets. A centre off the voxel lattice, without a symmetry of it, gives many more different
// triangulations, so that the steps of the ladder are small.
constexpr double kCoarsestRadiusVoxels = 1.6;
constexpr double kRadiusStep = 1.05;
constexpr Vec3d kCentreVoxels{0.37, 0.259, 0.148};
static_assert(kCoarsestRadiusVoxels >= LevelSet::kSmallestRadiusVoxels);

// Sagitta of a relaxed template times its squared radius in voxels, as measured: 0.145..0.18 over the ladder.
constexpr double kTypicalSagitta = 0.15;

// nullopt if a triangle does not face outward.
std::optional<BallTemplate> measured(const StarTriangulation& triangulation) {
  BallTemplate ball;
  double six_volumes = 0;
  for (std::uint32_t t = 0; t < triangulation.triangles().size(); ++t) {
    const auto [a, b, c] = triangulation.corners(t);
    const Vec3d area = cross(b - a, c - a);
    const double six_volume = dot(area, a);
    // The plane is nearest to the centre inside the triangle, or else the bound is on the safe side.
    const double depth = 1 - six_volume / length(area);
    if (!(six_volume > 0) || !(depth < 1)) return std::nullopt;
    ball.sagitta = std::max(ball.sagitta, depth);
    six_volumes += six_volume;
  }
  ball.volume_share = six_volumes / (8 * std::numbers::pi);
  // Triangles that all face outward could still wind twice around the centre.
  if (!(ball.volume_share < 1)) return std::nullopt;
  const std::span<const Vec3d> directions = triangulation.positions();
  ball.directions.assign(directions.begin(), directions.end());
  const std::span<const Triangle> triangles = triangulation.triangles();
  ball.triangles.assign(triangles.begin(), triangles.end());
  return ball;
}

// Greatest sagitta of a template for the ball, whose surface then lies at most `radius * sagitta + 2 *
// rounding_margin` deep. Negative or tiny if there is none.
double allowed_sagitta(const Sphere& ball, double tolerance) {
  return (tolerance - 2 * rounding_margin(ball)) / ball.radius;
}

// Does the template keep the surface within `tolerance` mm of the sphere, and enough of its volume?
bool suits(const BallTemplate& ball_template, const Sphere& ball, double tolerance) {
  const double shrunk = 1 - rounding_margin(ball) / ball.radius;
  return ball_template.sagitta <= allowed_sagitta(ball, tolerance) &&
         ball_template.volume_share * shrunk * shrunk * shrunk >= kLeastVolumeShare;
}

double radius_voxels(std::size_t level) {
  return kCoarsestRadiusVoxels * std::pow(kRadiusStep, static_cast<double>(level));
}

// Where to begin to look for a level with such a sagitta; monotone.
std::size_t likely_level(double sagitta) {
  const double radius = std::sqrt(kTypicalSagitta / sagitta);
  const double level = std::ceil(std::log(radius / kCoarsestRadiusVoxels) / std::log(kRadiusStep));
  return static_cast<std::size_t>(std::clamp(level, 0.0, static_cast<double>(BallLadder::kLevelCount)));
}

}  // namespace

std::optional<BallTemplate> project_onto_ball(const Mesh& surface, Vec3d centre) {
  std::vector<Vec3d> directions;
  directions.reserve(surface.positions.size());
  for (const Vec3f& p : surface.positions) directions.push_back(normalised(to_double(p) - centre));
  StarTriangulation triangulation(std::move(directions), surface.triangles);
  if (!triangulation.connect()) return std::nullopt;
  triangulation.flip_to_hull();
  return measured(triangulation);
}

std::optional<BallTemplate> relax(BallTemplate ball) {
  StarTriangulation triangulation(std::move(ball.directions), std::move(ball.triangles));
  if (!triangulation.connect()) return std::nullopt;
  // Passes at each power: 6 come within some per cent of what more of them reach. Going straight to the power
  // of 2 diverges.
  constexpr std::array<int, 3> kPasses{6, 6, 8};
  for (int power = 0; power < 3; ++power) {
    for (int pass = 0; pass < kPasses[static_cast<std::size_t>(power)]; ++pass) {
      triangulation.spread(power);
      triangulation.flip_to_hull();
    }
  }
  return measured(triangulation);
}

BallLadder::BallLadder() : levels_(kLevelCount) {}
BallLadder::~BallLadder() = default;

const BallLadder::Level& BallLadder::make(std::size_t level) {
  if (!levels_[level]) {
    auto made = std::make_unique<Level>();
    made->ball =
        project_onto_ball(LevelSet::of_ball(kCentreVoxels, radius_voxels(level), 1).surface(), kCentreVoxels);
    if (made->ball) made->ball = relax(std::move(*made->ball));
    levels_[level] = std::move(made);
  }
  return *levels_[level];
}

std::size_t BallLadder::level_for(const Sphere& ball, double tolerance) {
  check_resolvable(ball, tolerance);
  for (std::size_t level = likely_level(allowed_sagitta(ball, tolerance)); level < kLevelCount; ++level) {
    const std::optional<BallTemplate>& made = make(level).ball;
    if (made && suits(*made, ball, tolerance)) return level;
  }
  throw too_many_triangles(ball, tolerance);
}

const BallTemplate* BallLadder::find(std::size_t level) {
  const std::optional<BallTemplate>& made = make(level).ball;
  return made ? &*made : nullptr;
}

UsageError too_many_triangles(const Sphere& ball, double tolerance) {
  return UsageError(
      fmt::format("a void of radius {:f} mm at a tolerance of {:f} mm needs more than a million "
                  "triangles",
                  ball.radius, tolerance),
      "raise --tolerance");
}

void BallLadder::prepare(std::span<const Sphere> balls, double tolerance, Monitor& monitor) {
  constexpr std::size_t kLevelsAtOnce = 8;
  struct Search {
    const Sphere* ball;
    std::size_t level;
  };
  std::vector<Search> searches;
  for (const Sphere& ball : balls) {
    check_resolvable(ball, tolerance);
    searches.push_back({&ball, likely_level(allowed_sagitta(ball, tolerance))});
    if (searches.back().level >= kLevelCount) throw too_many_triangles(ball, tolerance);
  }
  const auto is_over = [&](Search& search) {
    for (; search.level < kLevelCount && levels_[search.level]; ++search.level) {
      const std::optional<BallTemplate>& made = levels_[search.level]->ball;
      if (made && suits(*made, *search.ball, tolerance)) return true;
    }
    return search.level >= kLevelCount;
  };
  while (true) {
    std::erase_if(searches, is_over);
    if (searches.empty()) return;
    std::vector<std::size_t> wanted;
    wanted.reserve(searches.size());
    for (const Search& search : searches) wanted.push_back(search.level);
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    for (std::size_t first = 0; first < wanted.size(); first += kLevelsAtOnce) {
      monitor.check_interrupted();
      tbb::parallel_for(first, std::min(wanted.size(), first + kLevelsAtOnce),
                        [&](std::size_t i) { make(wanted[i]); });
    }
  }
}

}  // namespace aerate
