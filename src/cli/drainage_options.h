#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/limit_options.h"
#include "pipeline/options.h"

namespace aerate::cli {

// --build
class BuildOption {
 public:
  explicit BuildOption(CLI::App& command);
  bool is_given() const { return option_->count() > 0; }
  Build build() const;

 private:
  std::string build_ = name_of(Build::standing);
  const CLI::Option* option_;
};

// --drain, --no-drain, the limits of drainage and of plugs, --escape-hole, --holes-on, --holes-not-on, --build, --drain-cavities, --plugs
class DrainageOptions {
 public:
  DrainageOptions(CLI::App& command, const ConfigFile& config);

  // These options with voids that drain, if they are to: as asked for, or because the process needs it. Throws
  // UsageError for options that contradict each other or the process.
  HollowOptions applied_to(HollowOptions options) const;

  // The file of plugs; empty unless asked for.
  const std::string& plugs() const { return plugs_; }

  // Whether the model's own cavities are to be opened.
  bool opens_cavities() const { return opens_cavities_; }

  // Whether --drain itself was given.
  bool is_asked_for() const { return drain_option_->count() > 0 && drain_; }

 private:
  void require_no_tubes() const;
  // Throws UsageError for limits of plugs without these.
  HollowOptions with_plugs_asked_for(HollowOptions options) const;
  // Throws UsageError for what is no point, all of it in one message.
  std::vector<Vec3d> escape_holes() const;

  // Throws UsageError for what is no side, and for sides beside two places.
  HoleSides sides(Vec3d up) const;

  bool drain_ = false;
  const CLI::Option* drain_option_;
  LimitOptions limits_, plug_limits_;
  std::string plugs_;
  std::vector<std::string> places_, on_, not_on_;
  BuildOption build_;
  bool opens_cavities_ = false;
};

}  // namespace aerate::cli
