#include "cli/limit_options.h"

#include <algorithm>
#include <fmt/format.h>
#include <string>

#include "cli/numbers.h"
#include "pipeline/process_choice.h"

namespace aerate::cli {
namespace {

// What a limit is that is not given.
std::string default_in_words(const LimitRow& row) {
  const auto has_none = [&](const Process& process) { return !process.limits.contains(row.limit); };
  switch (row.group) {
    case LimitGroup::packing:
      return fmt::format("default of the process, here of {}", processes().front().name);
    case LimitGroup::ceilings:
      return fmt::format(
          "default of the process; none for {}; ceilings are limited where there are both "
          "--overhang and --bridge",
          processes_that(has_none));
    default:
      return "default of the process";
  }
}

}  // namespace

LimitOptions::LimitOptions(CLI::App& command, const ConfigFile& config,
                           std::initializer_list<LimitGroup> groups)
    : config_(config) {
  for (const LimitRow& row : limit_rows()) {
    if (std::ranges::find(groups, row.group) == groups.end()) continue;
    const std::string help = fmt::format("{} ({})", row.explanation, default_in_words(row));
    CLI::Option* option = command.add_option(std::string(row.option), help)
                              ->check(number_between(row.least, row.most, std::string(row.unit.name)))
                              ->type_name(std::string(row.unit.placeholder));
    if (row.group == LimitGroup::packing)
      option->default_str(fmt::format("{:g}", processes().front().limits.at(row.limit).value));
    options_.emplace_back(row.limit, option);
  }
}

Limits LimitOptions::given() const {
  Limits given;
  for (const auto& [limit, option] : options_)
    if (option->count() > 0) given[limit] = {option->as<double>(), "", config_.origin_of(*option)};
  return given;
}

}  // namespace aerate::cli
