#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "kernels/roof.h"
#include "printing/ball_template.h"

namespace aerate {

// What a roof leaves of a ball's surface: a triangulation of the unit sphere below the height at which the
// cone touches it, seen with z up. It is open along a ring of vertices at that height, equally far apart.
struct CutBall {
  std::vector<Vec3d> directions;    // unit vectors; first the ring, counter-clockwise seen from above
  std::vector<Triangle> triangles;  // counter-clockwise seen from outside
  std::size_t ring_count = 0;
  double sagitta = 0;  // depth of the deepest point of a triangle, or of a plane that touches two neighbours
                       // of the ring along the cone, below the sphere or the cone
  double volume = 0;   // between the surface and the centre; of the unit ball 4/3 pi
};

// Puts a ring into a template of a whole ball and takes away what is above it. The ring has as many vertices
// as keep the cone within the template's sagitta. nullopt if the template's triangles cannot be made to run
// along the ring.
std::optional<CutBall> cut_ball(const BallTemplate& ball, const Roof& roof);

}  // namespace aerate
