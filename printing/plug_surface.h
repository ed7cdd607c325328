#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "core/mesh.h"
#include "kernels/vec.h"

namespace aerate {

// A plug for an escape hole, as it is printed: its inner end flat on z = 0, its axis up the z axis.
struct PlugShape {
  double radius = 0;   // where it is widest; no vertex is farther from its axis
  double tangent = 0;  // of the angle by which its side leans outwards
  std::size_t number = 0;
  // Of the outer end over a point of the plane; nothing where there is none.
  std::function<std::optional<double>(double x, double y)> height;
};

struct PlugSurface {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;      // one closed shell, outward; those of the outer end come first
  std::size_t outer_end_triangles = 0;  // how many these are
  double inner_radius = 0;
  double shortest = 0, longest = 0;  // least and largest height of the outer end
  bool is_numbered = false;          // the number is engraved on the inner end, unless that is too narrow
};

// What is shorter anywhere holds badly and leaves no room for its number, mm.
inline constexpr double kShortestPlug = 0.8;

// A frustum of a cone whose outer end has the heights of the shape. Nothing if it would be shorter than kShortestPlug
// somewhere, or if some height is not to be had.
std::optional<PlugSurface> plug_surface(const PlugShape& shape);

}  // namespace aerate
