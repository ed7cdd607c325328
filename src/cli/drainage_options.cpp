#include "cli/drainage_options.h"

#include <fmt/format.h>
#include <functional>
#include <utility>

#include "cli/numbers.h"
#include "core/error.h"
#include "core/listed.h"

namespace aerate::cli {
namespace {

const CLI::Option* add_drain(CLI::App& command, bool& drain) {
  const auto drains = [](const Process& process) { return process.drainage == Drainage::needed; };
  const std::string sealed = processes_that(std::not_fn(drains));
  return command.add_flag(
      "--drain,!--no-drain", drain,
      fmt::format("Join voids by channels and open them by escape holes, or leave them sealed "
                  "(default of the process: {} drain, {} {} not)",
                  processes_that(drains), sealed, sealed.find(' ') == std::string::npos ? "does" : "do"));
}

}  // namespace

DrainageOptions::DrainageOptions(CLI::App& command, const ConfigFile& config)
    : drain_option_(add_drain(command, drain_)), limits_(command, config, {LimitGroup::drainage}) {
  command
      .add_option("--escape-hole", places_,
                  "A point of the surface where an escape hole is to open, x,y,z in mm; may be repeated "
                  "(default where it shows least, low and high)")
      ->type_name("X,Y,Z")
      ->allow_extra_args(false)  // or it would take the model
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void DrainageOptions::require_no_tubes() const {
  const auto refuse = [](std::string_view option) {
    throw UsageError(fmt::format("{} is for voids that drain", option), "add --drain");
  };
  for (const auto& [limit, given] : limits_.given()) refuse(row_of(limit).option);
  if (!places_.empty()) refuse("--escape-hole");
}

std::vector<Vec3d> DrainageOptions::escape_holes() const {
  std::vector<Vec3d> points;
  std::vector<std::string> others;
  for (const std::string& place : places_) {
    if (const auto point = parse_point(place))
      points.push_back(*point);
    else
      others.push_back(fmt::format("'{}'", place));
  }
  if (!others.empty())
    throw UsageError(fmt::format("--escape-hole: {} {}", listed(others, "and"),
                                 others.size() == 1 ? "is no place" : "are no places"),
                     "give three numbers x,y,z");
  return points;
}

HollowOptions DrainageOptions::applied_to(HollowOptions options) const {
  const ProcessChoice& choice = options.packing.process;
  const bool drains = drain_option_->count() > 0 ? drain_ : choice.process.drainage == Drainage::needed;
  if (!drains) {
    require_no_tubes();
    return options;
  }
  options.packing.process = with_tubes(choice, limits_.given());
  options.drainage = drainage_request(options.packing.process, escape_holes());
  return options;
}

}  // namespace aerate::cli
