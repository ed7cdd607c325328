#include "cli/process_options.h"

#include <fmt/format.h>
#include <utility>

#include "cli/numbers.h"

namespace aerate::cli {
namespace {

// Of what is outside of a model: facets of steeper walls, and columns, are no finer than this.
constexpr double kLeastOverhang = 5, kMostOverhang = 85;  // degrees
constexpr double kLeastBridge = 1;                        // mm

const CLI::Option* add_up(CLI::App& command, std::string& up) {
  return command
      .add_option("--up", up, "Which way is up in print: +x, -x, +y, -y, +z, -z or x,y,z (write --up=-z)")
      ->check(
          parsed_by(parse_direction, "is no direction: give +x, -x, +y, -y, +z, -z or three numbers x,y,z"))
      ->type_name("DIRECTION")
      ->capture_default_str();
}

}  // namespace

DirectionOption::DirectionOption(CLI::App& command, const ConfigFile& config)
    : config_(config), option_(add_up(command, up_)) {}

PrintDirection DirectionOption::direction() const {
  if (option_->count() == 0) return {};
  return {parse_direction(up_).value(), up_, config_.origin_of(*option_)};
}

const CLI::Option* add_process_option(CLI::App& command, std::string& name, const std::string& what_it_does) {
  const auto list_if_asked = [](const std::string& given) -> std::string {
    if (given == "list") throw ProcessListRequest();
    return {};
  };
  return command
      .add_option("--process", name,
                  fmt::format("What prints it: {}, or a file of your own: its path, or its name if it is "
                              "~/.config/aerate/processes/NAME.json; {}; 'list' names every figure",
                              process_names(), what_it_does))
      ->check(CLI::Validator(list_if_asked, ""))
      ->type_name("NAME")
      ->capture_default_str();
}

OverhangOptions::OverhangOptions(CLI::App& command, const ConfigFile& config)
    : config_(config),
      overhang_(
          command
              .add_option("--overhang",
                          "Overhangs: what leans out further than this from the vertical needs supports "
                          "(default of the process)")
              ->check(number_between(kLeastOverhang, kMostOverhang, "degrees"))
              ->type_name("DEG")),
      bridge_(
          command
              .add_option("--bridge",
                          "Overhangs: width of the widest one that prints between two sides that hold it; "
                          "half of it, from one side (default of the process)")
              ->check(number_between(kLeastBridge, kLongest, "mm"))
              ->type_name("MM")) {}

Limits OverhangOptions::given() const {
  Limits given;
  for (const auto& [limit, option] :
       {std::pair(Limit::overhang, overhang_), std::pair(Limit::bridge, bridge_)})
    if (option->count() > 0) given[limit] = {option->as<double>(), "", config_.origin_of(*option)};
  return given;
}

ProcessOptions::ProcessOptions(CLI::App& command, const ConfigFile& config)
    : process_option_(add_process_option(command, process_,
                                         "sets the limits below where they are not given, and refuses those "
                                         "it cannot print")),
      limits_(command, config, {LimitGroup::packing, LimitGroup::ceilings}),
      direction_(command, config) {}

std::filesystem::path ProcessOptions::file() const {
  return process_file_of(process_);
}

ProcessChoice ProcessOptions::choice() const {
  ProcessChoice choice =
      limits_under(choose_process(process_), limits_.given(),
                   process_option_->count() > 0 ? ProcessCheck::strict : ProcessCheck::none);
  choice.direction = direction_.direction();
  return choice;
}

}  // namespace aerate::cli
