#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "pipeline/options.h"

namespace aerate::cli {

// --infill, --infill-pattern, --perimeters, --line-width, --layer-height, --top-layers, --bottom-layers,
// --force
class PrintOptions {
 public:
  explicit PrintOptions(CLI::App& command);

  // The print, if its infill was given. Throws UsageError for a print that contradicts itself, the process or
  // the limits that are to be packed under.
  std::optional<PrintSettings> settings(const PackingRequest& packing) const;
  HeavierPrint heavier() const { return force_ ? HeavierPrint::allow : HeavierPrint::refuse; }

 private:
  std::string infill_;
  CLI::Option* infill_option_ = nullptr;
  std::string pattern_ = "gyroid";
  PrintSettings settings_;
  bool force_ = false;
};

}  // namespace aerate::cli
