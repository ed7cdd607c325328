#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/cell_options.h"
#include "cli/model_options.h"
#include "cli/void_options.h"
#include "pipeline/options.h"
#include "pipeline/print_forms.h"

namespace aerate::cli {

// Options of the commands that hollow a model only to slice it: those of packing and of cells, --as,
// --modifier-infill, --slicer-path.
struct FormOptions {
  //   patterns: of slicers, that may be asked for beside
  FormOptions(CLI::App& command, const ConfigFile& config, const std::vector<std::string>& patterns = {});
  // Throws UsageError for options that contradict each other.
  FormRequest request(const ModelOptions& model) const;
  std::vector<NamedInput> inputs(const ModelOptions& model) const { return packing_.inputs(model.path); }

 private:
  PackingCommandOptions packing_;
  HollowOptions shaped(HollowOptions options, bool makes_cells) const;
  std::vector<HollowOptions> voids(const HollowOptions& options) const;
  HollowOptions modifiers(const HollowOptions& options) const;

  CellCommandOptions cells_;
  std::string as_ = "auto";
  double modifier_infill_percent_ = 0;
  ModifierOnlyOptions modifier_options_;
  std::string slicer_path_;
};

}  // namespace aerate::cli
