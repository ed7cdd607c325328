#pragma once

#include <array>
#include <vector>

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/surface_index.h"
#include "supports/teeth.h"
#include "supports/undersides.h"

namespace aerate {

// How much less than its clearance a body may keep, mm.
inline constexpr double kClearanceTolerance = 0.05;

struct BodyShape {
  double clearance = 0.8;     // between the body and the model, mm
  double tooth_height = 1.2;  // between the body and the ceilings that its teeth reach to, mm
  double foot = 2;            // half the width that it is not drawn in below, and its foot, mm
  double margin = 1.05;       // round what it carries, at its top, mm
  double least_voxel =
      0.45;  // no finer voxels than this are of use, mm; in finer ones more voids find a place
};

// The supports without their teeth: from below what they carry to the plate, or onto the model where that is in the way. On the way
// down it is drawn in by 45 degrees, no further than `foot` and than what keeps it upright, and what is slender gets a wider foot.
// Where bodies meet they are one. Empty where all is so low that teeth stand on the plate.
//   model: that `undersides` are of
Mesh support_body(const SurfaceIndex& model, const Undersides& undersides, const TeethPlan& teeth,
                  const BodyShape& shape, Monitor& monitor);

// Where something is carried, mm: from its ceiling to what is below.
struct CarriedPlace {
  double x, y;
  double ceiling, floor;
};

// The same as voxels: coordinates in columns, and in layers as high as a column is wide, from the plate up.
std::vector<std::array<int, 3>> body_voxels(const Undersides& columns,
                                            const std::vector<CarriedPlace>& carried, const BodyShape& shape,
                                            Monitor& monitor);

}  // namespace aerate
