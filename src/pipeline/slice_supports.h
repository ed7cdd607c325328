#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "pipeline/support.h"
#include "printing/slicers/slicers.h"

namespace aerate {

struct SliceSupportsOptions {
  std::filesystem::path output;           // .gcode
  const SlicerProfile* slicer = nullptr;  // one that has a format for parts
  std::filesystem::path slicer_path;      // it is looked for if empty
  SlicerSettings settings;
  SupportOptions support;  // with the model; `output` and `parts_for` are set here
};

// A model that was sliced with some supports, or with none.
struct SupportedForm {
  std::string name;
  GcodeFigures figures;
  double slicer_seconds = 0;  // wall-clock time of the slicer's run
};

struct SliceSupportsReport {
  std::filesystem::path model;
  Slicer slicer;
  std::filesystem::path output;
  SupportReport supports;
  std::vector<SupportedForm> forms;  // without supports, with these, with the slicer's own
  std::vector<std::string> failed;   // own ones that this version of the slicer has not
  std::vector<StageCost> stages;
  std::vector<std::string> notices;
};

// Makes supports and slices the model with them, which becomes the output, beside it without supports and with the slicer's own, all
// under the same settings. Throws what support_model() and slice() throw, UsageError for a slicer that is not there or has no format for
// parts.
SliceSupportsReport slice_supports(const SliceSupportsOptions& options, Monitor& monitor);

}  // namespace aerate
