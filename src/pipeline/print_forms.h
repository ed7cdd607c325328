#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "pipeline/options.h"
#include "pipeline/report.h"
#include "printing/slicers/slicers.h"

namespace aerate {

// What a model can be given to a slicer as.
enum class PrintForm {
  solid,      // as it is
  voids,      // hollowed, voids as inward shells
  modifiers,  // solid, with volumes of lower infill
};

const char* name_of(PrintForm form);

// How a model is to be sliced.
struct FormRequest {
  std::filesystem::path slicer_path;  // the slicer is looked for if empty
  // If not given, the form that takes the least filament by the slicer's figures; solid if none takes less.
  std::optional<PrintForm> form;
  double modifier_infill_percent = 0;
  HollowOptions hollow;  // with the model; `output` and `modifiers` are set for each form
};

// A form as the slicer printed it.
struct SlicedForm {
  PrintForm form = PrintForm::solid;
  GcodeFigures figures;
  std::filesystem::path gcode;         // in the scratch folder
  std::optional<HollowReport> hollow;  // how the model was made; absent for the solid one
  double slicer_seconds = 0;           // wall-clock time of the slicer's run
};

// What the reports of all that slices have.
struct FormsReport {
  std::vector<SlicedForm> forms;  // the first is solid
  std::size_t chosen = 0;
  std::vector<StageCost> stages;
  std::vector<std::string> notices;

  const SlicedForm& best() const { return forms[chosen]; }
};

// A model to be sliced in several forms under the same settings.
struct FormJob {
  const FormRequest& request;
  Slicer slicer;
  SlicerSettings settings;
  std::filesystem::path scratch;
  bool keep_place = false;  // see SliceJob
  // What the slicer is to call the object; after the model's file, as it does of its own, if empty.
  std::string object_name = {};
};

// Whether a model is a slicer's project, or may be one.
bool is_project(const std::filesystem::path& model);

// The forms to try. Throws UsageError for modifiers with a slicer that takes none.
std::vector<PrintForm> forms_to_try(std::optional<PrintForm> asked, const SlicerProfile& slicer);

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
std::size_t choose_form(const std::vector<SlicedForm>& forms, std::optional<PrintForm> asked);

}  // namespace aerate
