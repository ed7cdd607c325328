#pragma once

#include <filesystem>
#include <string>

#include "core/monitor.h"
#include "pipeline/print_forms.h"

namespace aerate {

struct HookOptions {
  std::filesystem::path gcode;  // as the slicer wrote it; replaced
  FormRequest request;          // without a model the G-code is annotated only
};

// The first form is what the file held; it is alone if nothing could be removed.
struct HookReport : FormsReport {
  std::filesystem::path gcode;
  GcodeOrigin origin;
  std::string remark;  // why the moves stayed as they were, or a form was left out

  const char* result() const { return chosen > 0 ? name_of(best().form) : "unchanged"; }
};

// A slicer's post-processing script. Re-slices the solid model with the settings that the G-code embeds; only
// if this gives the same extrusions, hollows the model, re-slices it and replaces the G-code by the best. The
// file gets a block of comments. Whatever is thrown, its content is what it was.
HookReport run_hook(const HookOptions& options, Monitor& monitor);

}  // namespace aerate
