#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/monitor.h"
#include "pipeline/options.h"
#include "pipeline/report.h"
#include "printing/slicers/slicers.h"
#include "view/scene.h"

namespace aerate {

// What a model can be given to a slicer as.
enum class PrintForm {
  solid,                // as it is
  voids,                // hollowed, voids as inward shells
  modifiers,            // solid, with volumes of lower infill
  lightning_modifiers,  // solid, with volumes that hold the slicer's lightning infill
  pattern,              // solid, in a sparse pattern of the slicer
};

const char* name_of(PrintForm form);

// What it is good for beside its filament, in a few words; not for patterns, whose slicer says so.
const char* use_of(PrintForm form);

// How a model is to be sliced.
struct FormRequest {
  std::filesystem::path slicer_path;  // the slicer is looked for if empty
  // If not given, the form that takes the least filament by the slicer's figures; solid if none takes less.
  std::optional<PrintForm> form;
  std::string pattern = {};  // the one asked for, where the form is a pattern
  double modifier_infill_percent = 0;
  HollowOptions
      hollow;  // with the model; `output`, `modifiers` and what describes the print are set for each form
  std::vector<HollowOptions> voids;  // the same in the shapes that voids may have, the preferred one first
  HollowOptions modifiers;           // the same in the shape of modifiers

  void set_model(const std::filesystem::path& model);  // of all of these
};

// A form as the slicer printed it.
struct SlicedForm {
  PrintForm form = PrintForm::solid;
  std::string pattern = {};  // of infill, where the form is a pattern
  GcodeFigures figures;
  std::filesystem::path gcode;         // in the scratch folder
  std::optional<HollowReport> hollow;  // how the model was made; absent for the solid one
  double slicer_seconds = 0;           // wall-clock time of the slicer's run
  std::optional<Scene> scene = {};     // of what was hollowed, where one is wanted

  std::string name() const { return form == PrintForm::pattern ? pattern : name_of(form); }
};

// A form that was not sliced.
struct SkippedForm {
  std::string name;
  std::optional<double> predicted;  // how much more filament than solid, as a share, if that is why
  std::string why = {};             // else
};

// What became of the forms that were to be tried.
struct TriedForms {
  std::vector<SlicedForm> sliced;
  std::vector<SkippedForm> skipped;
};

// What the reports of all that slices have.
struct FormsReport {
  std::vector<SlicedForm> forms;     // the first is solid
  std::vector<SkippedForm> skipped;  // other forms
  std::optional<DescribedPrint> print;
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
  bool supports_everywhere = false;  // the print has them wherever they are wanted, so in voids too
  bool wants_scenes = false;
  std::optional<BedPlace> place = {};  // see SliceJob
};

// Whether a model is a slicer's project, or may be one.
bool is_project(const std::filesystem::path& model);

// The forms to try beside patterns. Throws UsageError for modifiers with a slicer that takes none, or has no lightning.
//   with_lightning: modifiers that hold lightning among them, if the slicer has it
std::vector<PrintForm> forms_to_try(std::optional<PrintForm> asked, const SlicerProfile& slicer,
                                    bool with_lightning = false);

// What the print is, as far as a G-code of the slicer says.
std::optional<DescribedPrint> described_print(const SlicerProfile& slicer, std::string_view gcode);

// Whether a G-code of the slicer says that supports are built wherever they are wanted.
bool has_supports_everywhere(const SlicerProfile& slicer, std::string_view gcode);

// Slices the model as it is. Throws what load_model() and slice() throw.
SlicedForm slice_solid(const FormJob& job, Monitor& monitor);

// Slices the model as it is in patterns of the slicer. A pattern that it fails with is skipped, unless it was asked for.
//   solid: as slice_solid gave it
TriedForms slice_patterns(const std::vector<SparsePattern>& patterns, const SlicedForm& solid,
                          const FormJob& job, Monitor& monitor);

// Hollows the model for these forms, writes it in each, checked as any output, and slices it. Unless it was asked for, a
// form is skipped that nothing can be removed for, or that is predicted to take more filament than solid by more than the
// prediction may be off. Where supports are built everywhere, voids get support blockers, or a notice if the slicer has none.
// Throws what hollow() and slice() throw, NothingToRemoveError if nothing can be removed for any.
TriedForms slice_hollowed(const std::vector<PrintForm>& forms, const FormJob& job,
                          const std::optional<DescribedPrint>& print, Monitor& monitor);

// Why a form is no print of the model where the solid one is: the slicer put it elsewhere. Nothing if it is there.
std::optional<std::string> displacement_of(const SlicedForm& form, const std::vector<ExtrusionMove>& solid);

// Filament as the slicer gives it, in a unit that both have; fraction of `solid` that `other` saves. Throws
// FailureError if the slicer gives none.
double filament_saved(const GcodeFigures& solid, const GcodeFigures& other);

// Index of the form to use: forms[0] is solid, the others are those tried. No pattern unless it was asked for.
std::size_t choose_form(const std::vector<SlicedForm>& forms, std::optional<PrintForm> asked);

// Index of the form that takes the least filament, patterns among them; the first of equal ones.
std::size_t lightest_form(const std::vector<SlicedForm>& forms);

}  // namespace aerate
