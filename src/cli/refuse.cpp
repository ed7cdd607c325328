#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cli/commands.h"
#include "core/error.h"

namespace aerate::cli {
namespace {

// CLI11's words for a line of a configuration file that it can make nothing of, in ours.
std::string about_config(const CLI::App& app, std::string what) {
  constexpr std::string_view kUnknown = "INI was not able to parse ";
  if (what.starts_with(kUnknown)) what = "'" + what.substr(kUnknown.size()) + "' is no option";
  return app.get_config_ptr()->as<std::string>() + ": " + what;
}

}  // namespace

void refuse(const CLI::App& app, const CLI::ParseError& error) {
  std::string what = error.what();
  while (!what.empty() && what.back() == '\n') what.pop_back();
  if (dynamic_cast<const CLI::ConfigError*>(&error) != nullptr) {
    throw UsageError(about_config(app, what),
                     "its lines are options by their long names without dashes, as in 'wall = 1.2'");
  }
  std::string command = app.get_name();
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  for (const CLI::App* each : chosen) command += " " + each->get_name();
  const std::vector<std::string> unknown = app.remaining();
  if (chosen.empty() && !unknown.empty()) what = "'" + unknown.front() + "' is no command";
  const UsageError refusal(what, "see '" + command + " --help'");
  if (!chosen.empty() && chosen.front()->get_name() == "hook") throw on_one_line(refusal);
  throw refusal;
}

}  // namespace aerate::cli
