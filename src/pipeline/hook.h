#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/error.h"
#include "core/monitor.h"
#include "pipeline/print_forms.h"

namespace aerate {

struct HookOptions {
  std::filesystem::path gcode;   // as the slicer wrote it; replaced
  FormRequest request;           // without a model the G-code is annotated only
  std::optional<Error> refused;  // why there is no request: options that contradict each other
  // Where the model is looked for, by the name of the print, if it is not given (model_of_print.h).
  std::filesystem::path model_folder;
  // What cannot be done is thrown, instead of being told by a comment.
  bool is_strict = false;
  // What was saved is put into the name that the slicer gives the print.
  bool names_saving = false;
};

// The first form is what the file held; it is alone if nothing could be removed.
struct HookReport : FormsReport {
  std::filesystem::path gcode;
  GcodeOrigin origin;
  std::string remark;                   // why the moves stayed as they were, or a form was left out
  bool is_refused = false;              // they stayed since something could not be done
  std::optional<std::string> new_name;  // that the slicer was asked to give the print

  const char* result() const { return chosen > 0 ? name_of(best().form) : "unchanged"; }
};

// A slicer's post-processing script. Re-slices the solid model with the settings that the G-code embeds; only
// if this gives the same extrusions, hollows the model, re-slices it and replaces the G-code by the best. The
// file gets a block of comments. What goes wrong with a print costs nobody the print: it stays as it is, and the comments
// say why. Whatever is thrown (interruptions, a file that is no G-code of a slicer, and anything if it is to be strict), its content is
// what it was.
HookReport run_hook(const HookOptions& options, Monitor& monitor);

}  // namespace aerate
