#pragma once

#include "pipeline/options.h"

namespace aerate {

// The infill of modifiers that hold lightning, percent: how sparse its lines are where they meet what they hold.
inline constexpr double kLightningInfill = 15;

// Options for modifiers, which are to hold a slicer's lightning infill. It holds up what is above, so that unless the user
// said otherwise they have no roofs, and are one cell: walls between cells would be of infill that begins in the air.
HollowOptions holding_lightning(HollowOptions options, double infill_percent);

}  // namespace aerate
