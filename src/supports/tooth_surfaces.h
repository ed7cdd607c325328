#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh.h"
#include "core/surface_index.h"
#include "supports/teeth.h"
#include "supports/undersides.h"

namespace aerate {

struct ToothShape {
  double width = 0.5;        // of ridges, and of the flat tips of cones, mm
  double gap = 0.2;          // left free between a tooth and what it holds, mm
  double penetration = 0.1;  // where nothing is left free: by how much a tip is within what it holds, mm
  double embedded = 0.9;     // how deep a tooth goes into the body, mm
  double least_height =
      0.1;                // a lower tooth is none, mm; on the plate, where layers begin, 0.6 of that will do
  double most_alone = 8;  // with what is in the body, mm: a higher one stands if it is a sixth as long

  // No part of a tooth is nearer to the model, mm; across a slope the gap is narrower than along up.
  double least_distance() const { return 0.4 * gap; }
  // From the model to a tooth: negative within the model.
  double off() const { return gap > 0 ? gap : -penetration; }
};

// Closed shells, outward, each on its own; they run into the body and into each other.
struct ToothSurfaces {
  Mesh mesh;
  std::size_t count = 0;  // of teeth: runs of ridges, or cones
  double tip_area = 0;    // seen along up, mm2; ridges that cross count twice
  std::vector<std::uint32_t>
      left;  // spans farther from what holds them than the reach, near which no tooth has room
};

// From the body, or from what is below where there is none, to the ceilings of the model. `body`: null if there is none
ToothSurfaces teeth_below(const SurfaceIndex& model, const kernels::WindingView* body,
                          const Undersides& undersides, const TeethPlan& plan, const ToothShape& shape);

// On the model, or on the body where it goes on below, under a body whose `undersides` are not held otherwise.
ToothSurfaces teeth_on_model(const SurfaceIndex& model, const kernels::WindingView& body,
                             const Undersides& undersides, const TeethPlan& plan, const ToothShape& shape);

}  // namespace aerate
