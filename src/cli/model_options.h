#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/process_options.h"
#include "cli/terminal.h"
#include "core/packing.h"
#include "files/load.h"
#include "pipeline/options.h"

namespace aerate::cli {

// Options that several commands share. Each adds itself to a command and is read after parsing.

// Accepts any name but none.
CLI::Validator names_a_file();

// A file that a job reads, and what it is: "model", "configuration file".
struct NamedInput {
  std::string what;
  std::filesystem::path path;  // empty where there is none
};

// MODEL, --unit, --scale, --weld
struct ModelOptions {
  explicit ModelOptions(CLI::App& command);
  // The model as an option of this name that may be left out.
  ModelOptions(CLI::App& command, const std::string& name, const std::string& description);
  LoadOptions load() const;

  std::filesystem::path path;
  std::optional<double> weld;  // mm

 private:
  void add_size_options(CLI::App& command);

  std::string unit_;
  std::string scale_ = "1";
};

// The options of the process and its limits, --packing, --effort, --max-voids, --target-density, --device
struct PackingCommandOptions {
  PackingCommandOptions(CLI::App& command, const ConfigFile& config);
  // Throws UsageError for options that contradict each other.
  PackingRequest request() const;
  // The model and the files that the options come from.
  std::vector<NamedInput> inputs(const std::filesystem::path& model) const;

 private:
  const ConfigFile& config_;
  ProcessOptions process_;
  std::string packing_{packing_methods().front().name};
  std::string effort_ = "normal";
  std::optional<double> max_voids_;
  std::optional<double> target_density_;  // percent
  std::string device_ = "auto";
};

// --threads, --quiet, --json
struct RunOptions {
  explicit RunOptions(CLI::App& command);
  Verbosity verbosity() const { return quiet_ ? Verbosity::quiet : Verbosity::normal; }

  std::optional<int> threads;
  std::string json;  // a path, "-" for standard output, empty for none

 private:
  bool quiet_ = false;
};

}  // namespace aerate::cli
