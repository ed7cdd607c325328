#pragma once

#include <filesystem>

#include "core/monitor.h"
#include "pipeline/print_forms.h"

namespace aerate {

struct SliceModelOptions {
  std::filesystem::path output;  // .gcode
  const SlicerProfile* slicer = nullptr;
  SlicerSettings settings;
  FormRequest request;
};

struct SliceReport : FormsReport {
  std::filesystem::path model;
  Slicer slicer;
  std::filesystem::path output;
};

// Slices a model solid and hollowed with the user's own settings, and makes the better G-code the output.
// Throws what hollow() and slice() throw, UsageError for a slicer that is not there, InputError for settings.
SliceReport slice_model(const SliceModelOptions& options, Monitor& monitor);

}  // namespace aerate
