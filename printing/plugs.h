#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/drainage.h"
#include "core/mesh.h"
#include "core/solid.h"
#include "core/surface_index.h"

namespace aerate {

// How plugs are to fit the escape holes.
struct PlugFit {
  double clearance = 0;      // between a plug, where it is widest, and its hole, mm all round
  double taper_degrees = 0;  // by which its side leans away from the hole's, inwards
};

// A plug among others: printed standing on its inner end, its axis up.
struct Plug {
  std::size_t hole = 0;  // in the plan; its number is one more
  std::size_t first_triangle = 0, triangle_count = 0;
  std::size_t outer_end_triangles = 0;  // the first of these
  Vec3d place{0, 0, 0};                 // where its axis meets the build plate
  double radius = 0;                    // where it is widest
  double inner_radius = 0;
  double shortest = 0, longest = 0;  // along its side and across its outer end
  bool is_numbered = false;          // on its inner end

  TubeFrame frame;           // of the hole: x is `down`, y is `across`, z is `axis`
  Vec3d inner_end{0, 0, 0};  // what `place` is in the hole
  double room = 0;           // radius of the widest cylinder about the axis that goes through the hole
};

// A point of a plug where it is when it closes its hole.
Vec3d place_in_hole(const Plug& plug, Vec3d printed);

struct Plugs {
  Mesh mesh;  // shell after shell, in the order of the plugs
  std::vector<Plug> plugs;
  std::vector<std::size_t> without;  // holes in which there is no room for one
};

// Between two plugs on the build plate, mm.
inline constexpr double kPlugSpacing = 3;

// Plugs for the escape holes of a solid, in rows of ten in the order of the plan.
//
// A plug is a frustum of a cone that narrows inwards. Its inner end is flat and stays within the wall, or where that is
// too short within the hole; its outer end has the shape that the model's surface had there, so that it closes flush. Holes may be any
// polygons: what counts is the widest cylinder that goes through. Deterministic. O(triangles).
//
//   model, surface: the model without voids and holes, and its index
//   solid:          what was carved out of it by the plan
Plugs make_plugs(const Mesh& model, const SurfaceIndex& surface, const Solid& solid, const DrainagePlan& plan,
                 const PlugFit& fit);

}  // namespace aerate
