#pragma once

#include <optional>
#include <span>

#include "core/monitor.h"
#include "pipeline/carve_model.h"
#include "pipeline/options.h"
#include "pipeline/report.h"

namespace aerate {

// A hollowed model, and what its print takes, if that was said or is asked for.
struct HollowedForm {
  const HollowOptions* options = nullptr;
  HollowedModel hollowed;
  std::optional<PrintPrediction> print;
};

// Of the forms that the same job may take, the best. `forms`: at least one, the preferred one first; they read one model
// and write one file. Where the print is described, that which takes the least filament. Else the first, unless it
// cannot be made or leaves out much of what was packed; the others are then made as well, and that which removes most
// is taken, an escape hole being worth half a percent of it. Larger cells are made too where those of the first are several
// groups, each with two holes of its own. Of what was compared a notice has the figures. Throws what carve_model and
// predict_print throw for the first form if none can be made.
HollowedForm carve_best_form(std::span<const HollowOptions> forms, Monitor& monitor);

}  // namespace aerate
