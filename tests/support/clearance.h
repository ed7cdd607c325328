#pragma once

#include <cmath>
#include <limits>
#include <span>

#include "core/mesh.h"
#include "kernels/point_triangle.h"
#include "kernels/sphere.h"
#include "kernels/winding.h"

// What spheres must obey, found out without any index: the oracle of the packing tests.
namespace aerate::test {

inline double distance_to_surface(const Mesh& mesh, Vec3d p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& t : mesh.triangles) {
    nearest = std::min(nearest, kernels::distance_squared_to_facet(p, facet_of(mesh, t)));
  }
  return std::sqrt(nearest);
}

inline int winding_number(const Mesh& mesh, Vec3d p) {
  int winding = 0;
  for (const Triangle& t : mesh.triangles) {
    winding += kernels::winding_detail::facet_crossing(facet_of(mesh, t), p);
  }
  return winding;
}

// Smallest distance between the surfaces of two spheres; infinite for fewer than two.
inline double smallest_gap(std::span<const Sphere> spheres) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      smallest = std::min(
          smallest, length(spheres[i].centre - spheres[j].centre) - spheres[i].radius - spheres[j].radius);
    }
  }
  return smallest;
}

// Smallest distance between a sphere and the mesh; infinite without spheres.
inline double smallest_wall(const Mesh& mesh, std::span<const Sphere> spheres) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Sphere& sphere : spheres) {
    smallest = std::min(smallest, distance_to_surface(mesh, sphere.centre) - sphere.radius);
  }
  return smallest;
}

}  // namespace aerate::test
