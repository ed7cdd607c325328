#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/options.h"

namespace aerate::cli {

// --infill, --infill-pattern, --perimeters, --line-width, --layer-height, --top-layers, --bottom-layers,
// --force
class PrintOptions {
 public:
  explicit PrintOptions(CLI::App& command);

  // The print as far as it was described. Throws UsageError for a process that prints no filament.
  PrintSettings settings(const Process& process) const;
  bool knows_infill() const { return infill_option_->count() > 0; }
  // Throws UsageError for a described print that contradicts itself or the limits that are to be packed under.
  void require_lines_that_fit(const PackingLimits& limits) const;
  HeavierPrint heavier() const { return force_ ? HeavierPrint::allow : HeavierPrint::refuse; }

 private:
  // One of the options that describe the print, if one was given.
  const CLI::Option* given() const;

  std::string infill_;
  CLI::Option* infill_option_ = nullptr;
  std::vector<const CLI::Option*> options_;  // all that describe the print
  std::string pattern_ = "gyroid";
  PrintSettings settings_;
  bool force_ = false;
};

}  // namespace aerate::cli
