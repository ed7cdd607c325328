#include "cli/command_alone.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <string_view>

#include "cli/commands.h"
#include "cli/process_options.h"
#include "core/error.h"
#include "printing/processes.h"

namespace aerate::cli {
namespace {

// A call returns its report and its notices.
constexpr std::array<std::string_view, 3> kNotForCalls{"help", "json", "quiet"};

}  // namespace

void parse_alone(CLI::App& app, std::vector<std::string> arguments) {
  std::ranges::reverse(arguments);  // as the parser takes them
  try {
    app.parse(std::move(arguments));
  } catch (const ProcessListRequest&) {
    throw UsageError("--process list is for the command line", fmt::format("use one of {}", process_names()));
  } catch (const CLI::ParseError& error) {
    refuse(app, error);
  }
}

std::set<std::string> other_commands(const std::string& name) {
  std::set<std::string> commands{"hollow", "pack", "inspect", "support", "slice", "hook", "batch", "studio"};
  commands.erase(name);
  return commands;
}

std::vector<CalledOption> called_options(const std::vector<const CLI::Option*>& options) {
  std::vector<CalledOption> called;
  for (const CLI::Option* option : options) {
    if (option->get_lnames().empty()) continue;  // the model
    const std::string& name = option->get_lnames().front();
    if (std::ranges::find(kNotForCalls, name) != kNotForCalls.end()) continue;
    const OptionForm form = form_of(*option);
    const bool has_value = !form.is_flag || form.may_be_bare;
    called.push_back({name, form, has_value ? option->get_type_name() : "", option->get_description()});
  }
  return called;
}

}  // namespace aerate::cli
