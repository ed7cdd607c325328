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

// When a form is made beside those before it. If none of these could be made, or the best of them leaves out much of what
// was packed, or filament decides, each is.
enum class FormTrial {
  always,
  for_fewer_holes,  // cells of another size: if the best of those before it are several groups, or more than two holes drain one
  for_more_volume,  // else not
  otherwise,        // where none before it could be made, whatever else holds
};

// One way of doing a job.
struct JobForm {
  HollowOptions options;
  FormTrial tried = FormTrial::always;
};

// Of the forms that the same job may take, the best. `forms`: at least one, the preferred one first; they read one model
// and write one file. Where the print is described, that which takes the least filament. Else that which removes most of
// those that are tried, an escape hole being worth half a percent of it; the first where that makes no difference. Limits of
// another form that is always tried are no reason to remove less. Of what
// was compared a notice has the figures. Throws what carve_model and predict_print throw for the first form if none can be
// made.
//   models: of the job; those that were prepared for another form are not prepared again
HollowedForm carve_best_form(std::span<const JobForm> forms, PreparedModels& models, Monitor& monitor);

}  // namespace aerate
