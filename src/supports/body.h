#pragma once

#include "core/mesh.h"
#include "core/monitor.h"
#include "core/surface_index.h"
#include "supports/body_shape.h"
#include "supports/teeth.h"
#include "supports/undersides.h"

namespace aerate {

// How much less than its clearance a body may keep, mm.
inline constexpr double kClearanceTolerance = 0.05;

// The supports without their teeth: from below what they carry to the plate, or onto the model where that is in the way. On the way
// down it is drawn in by 45 degrees, no further than `foot` and than what keeps it upright, and what is slender gets a wider foot.
// Where bodies meet they are one. Empty where all is so low that teeth stand on the plate.
//   model: that `undersides` are of
Mesh support_body(const SurfaceIndex& model, const Undersides& undersides, const TeethPlan& teeth,
                  const BodyShape& shape, Monitor& monitor);

}  // namespace aerate
