#include "cli/process_options.h"

#include <fmt/format.h>
#include <iterator>
#include <optional>
#include <vector>

#include "cli/numbers.h"

namespace aerate::cli {

ProcessOptions::ProcessOptions(CLI::App& command, const ConfigFile& config)
    : config_(config),
      given_{{{.limit = Limit::wall},
              {.limit = Limit::gap},
              {.limit = Limit::min_radius},
              {.limit = Limit::max_radius},
              {.limit = Limit::overhang},
              {.limit = Limit::bridge}}} {
  const auto list_if_asked = [](const std::string& name) -> std::string {
    if (name == "list") throw ProcessListRequest();
    return {};
  };
  process_option_ =
      command
          .add_option(
              "--process", process_,
              "What prints it: fdm, sla, sls, metal, or a file of your own (.json); sets the limits below "
              "where they are not given, and refuses those it cannot print; 'list' names every figure")
          ->check(CLI::Validator(list_if_asked, ""))
          ->type_name("NAME")
          ->capture_default_str();

  constexpr const char* kWhat[] = {"Least thickness between a void and the model's surface",
                                   "Least thickness between two voids", "Smaller voids are not made",
                                   "Radius of the largest voids"};
  for (std::size_t i = 0; i < std::size(kWhat); ++i) {
    Given& given = given_[i];
    const bool may_be_zero = given.limit == Limit::wall || given.limit == Limit::gap;
    given.option =
        command
            .add_option(fmt::format("--{}", name_of(given.limit)), given.value,
                        fmt::format("{} (default of the process, here of fdm)", kWhat[i]))
            ->default_str(fmt::format("{:g}", (*find_process("fdm"))[given.limit]->value))
            ->check(number_between(may_be_zero ? std::optional(0.0) : std::nullopt, kLongest, "mm"))
            ->type_name("MM");
  }
  add_roof_options(command);
}

void ProcessOptions::add_roof_options(CLI::App& command) {
  Given& overhang = given_[4];
  Given& bridge = given_[5];
  overhang.option =
      command
          .add_option("--overhang", overhang.value,
                      "How far a ceiling may lean out before it needs support, in degrees from the vertical; "
                      "voids whose ceilings lean further and are wider than --bridge get a roof: a cone that "
                      "leans by this angle, cut flat where it is as wide as the bridge (default of the "
                      "process; none for sla and sls)")
          ->check(number_between({}, 90, "degrees from the vertical"))
          ->type_name("DEG");
  bridge.option =
      command
          .add_option("--bridge", bridge.value,
                      "Width of the widest flat ceiling that prints without support; one as wide as the "
                      "largest void leaves all voids spheres (default of the process; none for sla and sls)")
          ->check(number_between(0.0, kLongest, "mm"))
          ->type_name("MM");
  const auto is_direction = [](const std::string& text) {
    return parse_direction(text)
               ? std::string()
               : fmt::format("'{}' is no direction: give +x, -x, +y, -y, +z, -z or three numbers x,y,z",
                             text);
  };
  up_option_ = command
                   .add_option("--up", up_,
                               "Which way is up in print: +x, -x, +y, -y, +z, -z or x,y,z (write --up=-z)")
                   ->check(CLI::Validator(is_direction, ""))
                   ->type_name("DIRECTION")
                   ->capture_default_str();
}

ProcessChoice ProcessOptions::choice() const {
  std::vector<GivenLimit> given;
  for (const Given& own : given_)
    if (own.option->count() > 0) given.push_back({own.limit, own.value, config_.origin_of(*own.option)});
  ProcessChoice choice =
      limits_under(choose_process(process_), given,
                   process_option_->count() > 0 ? ProcessCheck::strict : ProcessCheck::none);
  if (up_option_->count() > 0)
    choice.direction = {parse_direction(up_).value(), up_, config_.origin_of(*up_option_)};
  return choice;
}

}  // namespace aerate::cli
