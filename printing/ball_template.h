#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/error.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "kernels/sphere.h"

// Triangulations of the unit sphere, made once from a level set, to be moved and scaled into the place of
// each void (void_surface.h).

namespace aerate {

// A closed convex-as-can-be triangulation whose vertices lie on the unit sphere.
struct BallTemplate {
  std::vector<Vec3d> directions;    // unit vectors
  std::vector<Triangle> triangles;  // counter-clockwise seen from outside
  double sagitta = 0;  // depth of the deepest point of a triangle below the sphere: 1 - its distance to the
                       // centre
  double volume_share = 0;  // volume over that of the ball
};

// Projects a closed surface around `centre` onto the unit sphere about it and splits its quads the way that
// loses the least volume. nullopt if the surface is not one closed 2-manifold of genus 0 all of whose
// triangles face away from the centre after the projection.
std::optional<BallTemplate> project_onto_ball(const Mesh& surface, Vec3d centre);

// Spreads the vertices so that the sagitta falls to about 1.25 times what equilateral triangles would have.
// nullopt if the result fails the checks of `project_onto_ball`.
std::optional<BallTemplate> relax(BallTemplate ball);

// A void keeps at least this share of its planned volume, however coarse its surface.
inline constexpr double kLeastVolumeShare = 0.9;

// Templates of increasing refinement, each made when it is first asked for: OpenVDB level sets of balls whose
// radius grows from level to level by 5 %, measured in voxels.
class BallLadder {
 public:
  static constexpr std::size_t kLevelCount = 95;  // the last has about 1.1 million triangles

  BallLadder();
  ~BallLadder();

  // The first level, and so about the coarsest, that keeps the surface of a ball within `tolerance` mm of the
  // sphere and its volume above 90 %. Throws UsageError if fp32 cannot hold it so exactly at its place, or
  // if that took more than about a million triangles.
  std::size_t level_for(const Sphere& ball, double tolerance);

  // Makes the levels that `level_for` will ask for, in parallel. Throws what it throws, as far as that is known
  // before any is made; InterruptedError.
  void prepare(std::span<const Sphere> balls, double tolerance, Monitor& monitor);

  // Of any level below kLevelCount, made if it is not yet; null if there is none at this refinement.
  const BallTemplate* find(std::size_t level);

  // Of a level that `level_for` has returned.
  const BallTemplate& operator[](std::size_t level) const { return *levels_[level]->ball; }

 private:
  struct Level {
    std::optional<BallTemplate> ball;  // nullopt if no template could be made at this refinement
  };
  const Level& make(std::size_t level);

  std::vector<std::unique_ptr<Level>> levels_;
};

// The error of `level_for`.
UsageError too_many_triangles(const Sphere& ball, double tolerance);

}  // namespace aerate
