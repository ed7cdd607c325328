#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/model_options.h"
#include "cli/void_options.h"
#include "pipeline/options.h"
#include "pipeline/print_forms.h"

namespace aerate::cli {

// Options of the commands that hollow a model only to slice it: those of packing, --tolerance, --as,
// --modifier-infill, --slicer-path.
struct FormOptions {
  FormOptions(CLI::App& command, const ConfigFile& config);
  // Throws UsageError for options that contradict each other.
  FormRequest request(const ModelOptions& model) const;
  std::vector<NamedInput> inputs(const ModelOptions& model) const { return packing_.inputs(model.path); }

 private:
  PackingCommandOptions packing_;
  double tolerance_ = HollowOptions{}.tolerance;
  std::string as_ = "auto";
  double modifier_infill_percent_ = 0;
  ModifierOnlyOptions modifier_options_;
  std::string slicer_path_;
};

}  // namespace aerate::cli
