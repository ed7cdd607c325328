#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/config_file.h"
#include "pipeline/options.h"
#include "printing/slicers/print_settings_file.h"

namespace aerate::cli {

// --infill, --infill-pattern, --perimeters, --line-width, --layer-height, --top-layers, --bottom-layers,
// --slicer-version, --vertical-shells, --wall-generator, --print-settings, --force
class PrintOptions {
 public:
  PrintOptions(CLI::App& command, const ConfigFile& config);

  // The options with the print as far as it was described, and the walls and gaps that follow from its lines. Throws
  // UsageError for a process that prints no filament, and what read_print_settings throws.
  HollowOptions applied_to(HollowOptions options) const;
  // Throws UsageError for a described print that contradicts itself or the limits that are to be packed under.
  void require_lines_that_fit(const HollowOptions& options) const;
  // The file of settings, if one was given.
  std::filesystem::path file() const { return file_; }

 private:
  struct Row {
    PrintSetting setting;
    CLI::Option* option;
  };

  // One of the options that describe the print, if one was given.
  const CLI::Option* given() const;
  const CLI::Option& option_for(PrintSetting setting) const;
  // Those of the file, with those of the command line in their place.
  FoundPrintSettings read() const;
  PrintOrigin origin_of(PrintSetting setting, const FoundPrintSettings& found,
                        const HollowOptions& options) const;

  const ConfigFile& config_;
  std::string infill_;
  std::vector<Row> rows_;  // all that describe the print but for the file
  CLI::Option* file_option_ = nullptr;
  std::string file_;
  std::string pattern_ = "gyroid";
  std::string version_ = "2.5", shells_ = "enabled", walls_ = "arachne";
  PrintSettings settings_;
  bool force_ = false;
};

}  // namespace aerate::cli
