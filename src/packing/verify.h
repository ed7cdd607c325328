#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/mesh.h"
#include "core/packing.h"

namespace aerate {

// Checks every sphere in fp64 against the mesh (wall, winding number) and against its neighbours (gap),
// shrinks what is too large by no more than rounding explains, and drops the rest and whatever became smaller
// than min_radius. The counts are added to the packing's statistics. Always run on a packing before it is
// used.
Packing verify_packing(const Mesh& mesh, Packing packing);

// Exact (fp64) distance from each centre to the surface of `mesh`.
std::vector<double> distances_to_surface(const Mesh& mesh, std::span<const Vec3d> points);

// Smallest clearances of a set of balls: to the surface, and between two balls (nullopt for fewer than two).
struct Clearances {
  double wall = 0;
  std::optional<double> gap;
};
Clearances measure_clearances(const Mesh& mesh, std::span<const Sphere> spheres);

// The largest ball that fits inside the model (its clearance to the surface), for the message when nothing
// fits under the limits: centre, and its radius with no wall at all. Accurate to about 1 %.
Sphere largest_inscribed_sphere(const Mesh& mesh);

}  // namespace aerate
