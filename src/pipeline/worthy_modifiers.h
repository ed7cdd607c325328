#pragma once

#include <functional>

#include "core/monitor.h"
#include "core/packing.h"
#include "core/solid.h"
#include "pipeline/options.h"
#include "pipeline/prepare.h"

namespace aerate {

// The spheres of a packing that are worth being modifiers. Small ones save next to nothing, and each is a region of its own
// in every layer, which takes time: so the least radius is the largest with which no more than half a percent more filament
// is predicted than with the best one. A notice tells which. All of them where nothing is predicted.
//   solid_of: the model with the voids of such a packing
Packing worthy_modifiers(const PreparedModel& model, const Packing& packing, const HollowOptions& options,
                         const std::function<Solid(const Packing& some)>& solid_of, Monitor& monitor);

}  // namespace aerate
