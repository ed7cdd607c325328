#include "cli/drainage_options.h"

#include <fmt/format.h>

#include "cli/numbers.h"
#include "core/error.h"

namespace aerate::cli {

DrainageOptions::DrainageOptions(CLI::App& command, const ConfigFile& config) : config_(config) {
  drain_option_ = command.add_flag(
      "--drain,!--no-drain", drain_,
      "Join voids by channels and open them by escape holes, or leave them sealed (default of the process: "
      "sla, sls and metal drain, fdm does not)");
  channel_option_ = command
                        .add_option("--channel-diameter", channel_,
                                    "Diameter of the channels that join voids (default of the process)")
                        ->check(number_between({}, kLongest, "mm"))
                        ->type_name("MM");
  hole_option_ =
      command
          .add_option("--hole-diameter", hole_,
                      "Diameter of the escape holes, no less than that of channels (default of the "
                      "process)")
          ->check(number_between({}, kLongest, "mm"))
          ->type_name("MM");
  const auto is_place = [](const std::string& text) {
    return parse_point(text) ? std::string()
                             : fmt::format("'{}' is no place: give three numbers x,y,z", text);
  };
  places_option_ =
      command
          .add_option("--escape-hole", places_,
                      "A point of the surface where an escape hole is to open, x,y,z in mm; may be repeated "
                      "(default where it shows least, low and high)")
          ->check(CLI::Validator(is_place, ""))
          ->type_name("X,Y,Z")
          ->take_all();
}

bool DrainageOptions::is_wanted(const Process& process) const {
  if (drain_option_->count() > 0) return drain_;
  return process.drainage == Drainage::needed;
}

double DrainageOptions::diameter(ProcessChoice& choice, Limit limit, const CLI::Option& option,
                                 double given) const {
  LimitOrigin chosen{
      .limit = limit,
      .value = given,
      .origin = option.count() > 0 ? config_.origin_of(option) : "default of " + choice.process.name,
      .source = {}};
  if (option.count() == 0) {
    const auto& figure = choice.process[limit];
    if (!figure) {
      throw UsageError(fmt::format("process {}: --drain needs the diameter of {}", choice.process.name,
                                   limit == Limit::channel ? "channels" : "escape holes"),
                       fmt::format("give {}", option.get_name()));
    }
    chosen.value = figure->value;
    chosen.source = figure->source;
  }
  choice.origins.push_back(chosen);
  return chosen.value;
}

std::optional<DrainageRequest> DrainageOptions::request(ProcessChoice& choice) const {
  if (!is_wanted(choice.process)) {
    for (const CLI::Option* option : {channel_option_, hole_option_, places_option_}) {
      if (option->count() > 0)
        throw UsageError(fmt::format("{} is for voids that drain", option->get_name()), "add --drain");
    }
    return std::nullopt;
  }
  DrainageRequest request;
  request.channel_radius = diameter(choice, Limit::channel, *channel_option_, channel_) / 2;
  request.hole_radius = diameter(choice, Limit::escape_hole, *hole_option_, hole_) / 2;
  if (request.hole_radius < request.channel_radius) {
    throw UsageError(fmt::format("escape holes of {:g} mm are narrower than channels of {:g} mm",
                                 2 * request.hole_radius, 2 * request.channel_radius),
                     "give a larger --hole-diameter or a smaller --channel-diameter");
  }
  for (const std::string& place : places_) request.escape_holes.push_back(parse_point(place).value());
  return request;
}

}  // namespace aerate::cli
