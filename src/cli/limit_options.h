#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <utility>
#include <vector>

#include "cli/config_file.h"
#include "printing/processes.h"

namespace aerate::cli {

// An option for each limit of some groups, as the rows of limits say.
class LimitOptions {
 public:
  LimitOptions(CLI::App& command, const ConfigFile& config, std::initializer_list<LimitGroup> groups);

  Limits given() const;

 private:
  const ConfigFile& config_;
  std::vector<std::pair<Limit, const CLI::Option*>> options_;
};

}  // namespace aerate::cli
