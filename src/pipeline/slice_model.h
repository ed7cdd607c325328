#pragma once

#include <filesystem>
#include <string>

#include "core/monitor.h"
#include "pipeline/print_forms.h"

namespace aerate {

// What is sliced beside solid, voids and modifiers, if nothing was asked for by name.
enum class Comparison {
  forms,  // nothing
  lightning,  // the solid model in the slicer's pattern that takes least, if its G-code says how dense the print is
  patterns,  // in all its sparse patterns, and modifiers that hold lightning
};

struct SliceModelOptions {
  std::filesystem::path output;  // .gcode
  const SlicerProfile* slicer = nullptr;
  SlicerSettings settings;
  FormRequest request;
  Comparison comparison = Comparison::lightning;
  ViewOutputs views;  // of the form that is written
};

struct SliceReport : FormsReport {
  std::filesystem::path model;
  Slicer slicer;
  std::filesystem::path output;

  // Of all that was sliced, what takes the least filament: it may be a pattern, which is not written unless asked for.
  const SlicedForm& lightest() const { return forms[lightest_form(forms)]; }
  // What the slicer's pattern of a form is good for.
  std::string use(const SlicedForm& form) const;
};

// Slices a model solid and hollowed with the user's own settings, and in the slicer's sparse patterns, and makes the better
// G-code of solid and hollowed the output, or that of the pattern that was asked for.
// Throws what hollow() and slice() throw, UsageError for a slicer that is not there, InputError for settings.
SliceReport slice_model(const SliceModelOptions& options, Monitor& monitor);

}  // namespace aerate
