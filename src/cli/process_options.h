#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <string>

#include "cli/config_file.h"
#include "pipeline/process_choice.h"

namespace aerate::cli {

// Thrown while options are read for `--process list`: the processes are to be listed, and nothing else done.
class ProcessListRequest : public CLI::Success {};

// --process, --wall, --gap, --min-radius, --max-radius, --overhang, --bridge, --up
class ProcessOptions {
 public:
  ProcessOptions(CLI::App& command, const ConfigFile& config);

  // Throws UsageError for limits that contradict each other or the process.
  ProcessChoice choice() const;

 private:
  void add_roof_options(CLI::App& command);

  struct Given {
    Limit limit;
    double value = 0;
    CLI::Option* option = nullptr;
  };

  const ConfigFile& config_;
  std::string process_ = "fdm";
  CLI::Option* process_option_ = nullptr;
  std::array<Given, 6> given_;
  std::string up_ = PrintDirection{}.name;
  CLI::Option* up_option_ = nullptr;
};

}  // namespace aerate::cli
