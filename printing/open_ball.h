#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/drainage.h"
#include "core/mesh.h"
#include "kernels/sphere.h"
#include "printing/star_triangulation.h"

namespace aerate {

// Where a tube opens into a ball: the points of `VoidShape::rim`, counter-clockwise seen from outside the
// ball.
struct Opening {
  Tube tube;
  TubeEnd end = TubeEnd::start;  // the end at which the ball is
  std::vector<Vec3d> ring;
};

// The surface of a ball with openings, facing outward, open along the rings and nowhere else.
struct OpenedBall {
  std::vector<Vec3d> positions;  // the rings' points first, in the order given; all on the sphere
  std::vector<Triangle> triangles;
  double nearest = 0;  // least distance of a triangle's plane from the centre
};

// The convex hull of the rings' points and of the points that `whole`, a connected triangulation of the unit
// sphere that is its own hull, has on the ball, but for those near a ring; less what is inside the rings. All
// points lie on one sphere, so an edge of a ring is an edge of the hull as soon as no other point lies in the
// ball that has it for a diameter: points that do are left out. The hull changes near the rings alone, so it
// is found by taking those points out of `whole`, putting the rings in, and flipping edges. nullopt if the
// openings are too near to each other for that, or leave too few points.
std::optional<OpenedBall> open_ball(const Sphere& ball, const StarTriangulation& whole,
                                    std::span<const Opening> openings);

}  // namespace aerate
