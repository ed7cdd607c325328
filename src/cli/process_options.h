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

// --process, the limits of packing and of ceilings, --up
class ProcessOptions {
 public:
  ProcessOptions(CLI::App& command, const ConfigFile& config);

  // The process file, if it is one of the user's own.
  std::filesystem::path file() const;

  // Throws UsageError for limits that contradict each other or the process.
  ProcessChoice choice() const;

 private:
  const ConfigFile& config_;
  std::string process_ = processes().front().name;
  const CLI::Option* process_option_;
  LimitOptions limits_;
  std::string up_ = PrintDirection{}.name;
  const CLI::Option* up_option_;
};

}  // namespace aerate::cli
