#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "pipeline/print_forms.h"

namespace aerate {

struct HookOptions {
  std::filesystem::path gcode;        // as the slicer wrote it; replaced
  std::filesystem::path slicer_path;  // the slicer that wrote it is looked for if empty
  FormChoice form = FormChoice::automatic;
  double modifier_infill_percent = 0;
  HollowOptions hollow;  // without a model the G-code is annotated only
};

struct HookReport {
  std::filesystem::path gcode;
  GcodeOrigin origin;
  std::vector<SlicedForm> forms;  // the first is what the file held; alone if nothing could be removed
  std::size_t chosen = 0;
  std::string remark;  // why the moves stayed as they were, if they did
  std::vector<StageCost> stages;
  std::vector<std::string> notices;
};

// A slicer's post-processing script. Re-slices the solid model with the settings that the G-code embeds; only
// if this gives the same extrusions, hollows the model, re-slices it and replaces the G-code by the best. The
// file gets a block of comments. Whatever is thrown, its content is what it was.
HookReport run_hook(const HookOptions& options, Monitor& monitor);

}  // namespace aerate
