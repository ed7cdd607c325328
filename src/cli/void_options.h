#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/config_file.h"
#include "pipeline/process_choice.h"

namespace aerate::cli {

// Options of how voids are made, for every command that makes them. Each adds itself with the value that is
// there as the default.
void add_tolerance(CLI::App& command, double& tolerance);
const CLI::Option* add_modifier_infill(CLI::App& command, double& percent);

// Options that modifiers alone have. Those of a configuration file may stand there for other runs.
class ModifierOnlyOptions {
 public:
  explicit ModifierOnlyOptions(const ConfigFile& config) : config_(config) {}
  void add(const CLI::Option* option) { options_.push_back(option); }
  // Throws UsageError for one that was given on the command line; `where`: "without --as modifiers".
  void require_none(const std::string& where) const;

 private:
  const ConfigFile& config_;
  std::vector<const CLI::Option*> options_;
};

// Throws UsageError for a tolerance (mm) that would leave little of the smallest voids.
void require_tolerance_for(const ProcessChoice& choice, double tolerance);

}  // namespace aerate::cli
