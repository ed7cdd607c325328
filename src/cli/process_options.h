#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "cli/config_file.h"
#include "cli/limit_options.h"
#include "pipeline/process_choice.h"

namespace aerate::cli {

// Thrown while options are read for `--process list`: the processes are to be listed, and nothing else done.
class ProcessListRequest : public CLI::Success {};

// --up
class DirectionOption {
 public:
  DirectionOption(CLI::App& command, const ConfigFile& config);
  // The default if it was not given.
  PrintDirection direction() const;
  bool is_given() const { return option_->count() > 0; }

 private:
  const ConfigFile& config_;
  std::string up_ = PrintDirection{}.name;
  const CLI::Option* option_;
};

// --process, with what it is said to be for. `name` holds the default.
const CLI::Option* add_process_option(CLI::App& command, std::string& name, const std::string& what_it_does);

// --overhang and --bridge of what is outside of a model.
class OverhangOptions {
 public:
  OverhangOptions(CLI::App& command, const ConfigFile& config);
  bool are_given() const { return overhang_->count() + bridge_->count() > 0; }
  Limits given() const;

 private:
  const ConfigFile& config_;
  const CLI::Option *overhang_, *bridge_;
};

// --process, the limits of packing and of ceilings, --up
class ProcessOptions {
 public:
  ProcessOptions(CLI::App& command, const ConfigFile& config);

  // The process file, if it is one of the user's own.
  std::filesystem::path file() const;

  // Throws UsageError for limits that contradict each other or the process.
  ProcessChoice choice() const;

 private:
  std::string process_ = processes().front().name;
  const CLI::Option* process_option_;
  LimitOptions limits_;
  DirectionOption direction_;
};

}  // namespace aerate::cli
