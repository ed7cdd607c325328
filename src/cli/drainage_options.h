#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/config_file.h"
#include "core/drainage.h"
#include "pipeline/process_choice.h"

namespace aerate::cli {

// --drain, --no-drain, --channel-diameter, --hole-diameter, --escape-hole
class DrainageOptions {
 public:
  DrainageOptions(CLI::App& command, const ConfigFile& config);

  // How voids are to drain, if they are: as asked for, or because the process needs it. Adds the diameters to
  // the limits of `choice`, with where they came from. Throws UsageError for options that contradict each
  // other or the process.
  std::optional<DrainageRequest> request(ProcessChoice& choice) const;

  // Whether --drain itself was given.
  bool is_asked_for() const { return drain_option_->count() > 0 && drain_; }

 private:
  bool is_wanted(const Process& process) const;
  double diameter(ProcessChoice& choice, Limit limit, const CLI::Option& option, double given) const;

  const ConfigFile& config_;
  bool drain_ = false;
  CLI::Option* drain_option_ = nullptr;
  double channel_ = 0;
  CLI::Option* channel_option_ = nullptr;
  double hole_ = 0;
  CLI::Option* hole_option_ = nullptr;
  std::vector<std::string> places_;
  CLI::Option* places_option_ = nullptr;
};

}  // namespace aerate::cli
