#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "pipeline/print_forms.h"

namespace aerate {

struct SliceModelOptions {
  std::filesystem::path output;  // .gcode
  SlicerKind slicer = SlicerKind::prusa_slicer;
  std::filesystem::path slicer_path;  // looked for if empty
  SlicerSettings settings;
  FormChoice form = FormChoice::automatic;
  double modifier_infill_percent = 0;
  HollowOptions hollow;  // with the model
};

struct SliceReport {
  std::filesystem::path model;
  Slicer slicer;
  FormChoice choice = FormChoice::automatic;
  std::vector<SlicedForm> forms;  // the first is solid
  std::size_t chosen = 0;
  std::filesystem::path output;
  std::vector<StageCost> stages;
  std::vector<std::string> notices;
};

// Slices a model solid and hollowed with the user's own settings, and makes the better G-code the output.
// Throws what hollow() and slice() throw, UsageError for a slicer that is not there, InputError for settings.
SliceReport slice_model(const SliceModelOptions& options, Monitor& monitor);

}  // namespace aerate
