#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/monitor.h"
#include "pipeline/options.h"
#include "pipeline/report.h"
#include "printing/slicers/slicer.h"

namespace aerate {

// What a model can be given to a slicer as.
enum class PrintForm {
  solid,      // as it is
  voids,      // hollowed, voids as inward shells
  modifiers,  // solid, with volumes of lower infill
};

const char* name_of(PrintForm form);

// Which of the hollowed forms may be used.
enum class FormChoice {
  automatic,  // the one that takes the least filament by the slicer's figures; solid if none takes less
  voids,
  modifiers,
};

// A form as the slicer printed it.
struct SlicedForm {
  PrintForm form = PrintForm::solid;
  GcodeFigures figures;
  std::filesystem::path gcode;         // in the scratch folder
  std::optional<HollowReport> hollow;  // how the model was made; absent for the solid one
  double slicer_seconds = 0;           // wall-clock time of the slicer's run
};

// A model to be sliced in several forms under the same settings.
struct FormJob {
  Slicer slicer;
  SlicerSettings settings;
  HollowOptions hollow;  // `output` and `modifiers` are set for each form
  double modifier_infill_percent = 0;
  bool keep_place = false;  // see SliceJob
  std::filesystem::path scratch;
};

// The forms to try. Throws UsageError for modifiers with a slicer that takes none.
std::vector<PrintForm> forms_to_try(FormChoice choice, SlicerKind slicer);

// Slices the model as it is. Throws what load_model() and slice() throw.
SlicedForm slice_solid(const FormJob& job, Monitor& monitor);

// Hollows the model once, writes it in these forms, each checked as any output, and slices them. Throws what
// hollow() and slice() throw.
std::vector<SlicedForm> slice_hollowed(const std::vector<PrintForm>& forms, const FormJob& job,
                                       Monitor& monitor);

// Filament as the slicer gives it, in a unit that both have; fraction of `solid` that `other` saves. Throws
// FailureError if the slicer gives none.
double filament_saved(const GcodeFigures& solid, const GcodeFigures& other);

// Index of the form to use: forms[0] is solid, the others are those tried.
std::size_t choose_form(const std::vector<SlicedForm>& forms, FormChoice choice);

}  // namespace aerate
