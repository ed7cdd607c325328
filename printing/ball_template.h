#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/solid.h"
#include "kernels/sphere.h"

// How the balls of a plan become shells: triangulations of the unit sphere, made once from a level set and
// then moved and scaled into place.

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

// How far inside a ball its vertices are planned, mm, so that none leaves it when it is rounded to fp32.
double rounding_margin(const Sphere& ball);

// The outer surface and the balls' as voids, facing inward, by a template for each. All of a void's surface
// lies within its ball. Throws FailureError for more vertices than 32 bits can count.
Solid assemble(Mesh outer, std::span<const Sphere> balls, std::span<const BallTemplate* const> templates);

// Templates of increasing refinement, each made when it is first asked for: OpenVDB level sets of balls whose
// radius grows from level to level by 5 %, measured in voxels.
class BallLadder {
 public:
  BallLadder();
  ~BallLadder();

  // The first level, and so about the coarsest, that keeps the surface of a ball within `tolerance` mm of the
  // sphere and its volume above 90 %. Throws FailureError if fp32 cannot hold it so exactly at its place, or
  // if that took more than about a million triangles.
  std::size_t level_for(const Sphere& ball, double tolerance);

  // Makes the levels that `level_for` will probably ask for, in parallel.
  void prepare(std::span<const Sphere> balls, double tolerance);

  // Of a level that `level_for` has returned.
  const BallTemplate& operator[](std::size_t level) const { return *levels_[level]->ball; }

 private:
  struct Level {
    std::optional<BallTemplate> ball;  // nullopt if no template could be made at this refinement
  };
  const Level& make(std::size_t level);

  std::vector<std::unique_ptr<Level>> levels_;
};

}  // namespace aerate
