#include "cli/process_options.h"

#include <fmt/format.h>
#include <optional>
#include <vector>

#include "cli/numbers.h"

namespace aerate::cli {

ProcessOptions::ProcessOptions(CLI::App& command, const ConfigFile& config)
    : config_(config),
      given_{{{.limit = Limit::wall},
              {.limit = Limit::gap},
              {.limit = Limit::min_radius},
              {.limit = Limit::max_radius}}} {
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
  for (std::size_t i = 0; i < given_.size(); ++i) {
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
