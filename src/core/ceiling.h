#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/mesh.h"
#include "kernels/roof.h"

namespace aerate {

// A facet is part of a ceiling if it leans out by so much more than the overhang angle: the facets of a wall
// that leans by just that angle lean a little more and a little less.
inline constexpr double kCeilingMarginDegrees = 5;

// A point seen along `up`.
struct PointFromAbove {
  double x, y;
};

// Facets of a void that join along edges and lean out of the vertical by at least the overhang angle and
// kCeilingMarginDegrees, seen along `up`: their rim, and the area within.
struct Ceiling {
  std::vector<std::pair<PointFromAbove, PointFromAbove>> rim;
  double area = 0;

  // No disc in it is wider.
  double bound() const;
};

// Of a shell that faces into a void. O(triangles log triangles).
std::vector<Ceiling> ceilings_of(const Mesh& mesh, std::span<const Triangle> shell, const Roof& roof);

// Diameter of the largest disc that fits into a ceiling, to 0.001 mm, if that is more than `known`; else `known`.
double widest_disc(const Ceiling& ceiling, double known);

}  // namespace aerate
