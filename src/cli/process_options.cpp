#include "cli/process_options.h"

#include <fmt/format.h>

#include "cli/numbers.h"

namespace aerate::cli {
namespace {

const CLI::Option* add_process(CLI::App& command, std::string& name) {
  const auto list_if_asked = [](const std::string& given) -> std::string {
    if (given == "list") throw ProcessListRequest();
    return {};
  };
  return command
      .add_option(
          "--process", name,
          fmt::format("What prints it: {}, or a file of your own (.json); sets the limits below where "
                      "they are not given, and refuses those it cannot print; 'list' names every figure",
                      process_names()))
      ->check(CLI::Validator(list_if_asked, ""))
      ->type_name("NAME")
      ->capture_default_str();
}

const CLI::Option* add_up(CLI::App& command, std::string& up) {
  return command
      .add_option("--up", up, "Which way is up in print: +x, -x, +y, -y, +z, -z or x,y,z (write --up=-z)")
      ->check(
          parsed_by(parse_direction, "is no direction: give +x, -x, +y, -y, +z, -z or three numbers x,y,z"))
      ->type_name("DIRECTION")
      ->capture_default_str();
}

}  // namespace

ProcessOptions::ProcessOptions(CLI::App& command, const ConfigFile& config)
    : config_(config),
      process_option_(add_process(command, process_)),
      limits_(command, config, {LimitGroup::packing, LimitGroup::ceilings}),
      up_option_(add_up(command, up_)) {}

std::filesystem::path ProcessOptions::file() const {
  return is_process_file(process_) ? process_ : std::string();
}

ProcessChoice ProcessOptions::choice() const {
  ProcessChoice choice =
      limits_under(choose_process(process_), limits_.given(),
                   process_option_->count() > 0 ? ProcessCheck::strict : ProcessCheck::none);
  if (up_option_->count() > 0)
    choice.direction = {parse_direction(up_).value(), up_, config_.origin_of(*up_option_)};
  return choice;
}

}  // namespace aerate::cli
