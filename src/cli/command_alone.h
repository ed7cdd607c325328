#pragma once

#include <CLI/CLI.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/called_commands.h"
#include "cli/config_file.h"

namespace aerate::cli {

// Parses the arguments of the one command that a program has. Throws UsageError as the program itself does, and for
// `--process list`.
void parse_alone(CLI::App& app, std::vector<std::string> arguments);

// The commands of the program but this one.
std::set<std::string> other_commands(const std::string& name);

// Those of them that a call may have.
std::vector<CalledOption> called_options(const std::vector<const CLI::Option*>& options);

// The options of a command, in a program that does nothing else. `Job` is made of a command and a configuration file.
template <typename Job>
class CommandAlone {
 public:
  explicit CommandAlone(const char* name)
      : config_(app_, other_commands(name)),
        command_(*app_.add_subcommand(name, "")),
        job_(command_, config_) {
    app_.require_subcommand(1);
  }
  // With the options of a call read, which need no output.
  CommandAlone(const char* name, const Call& call) : CommandAlone(name) {
    if (CLI::Option* const output = command_.get_option_no_throw("--output")) output->required(false);
    parse("model", call.arguments);
    job_.model.path = call.model;
  }

  void parse(const std::string& model, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {command_.get_name(), model});
    parse_alone(app_, std::move(arguments));
  }

  std::vector<const CLI::Option*> command_options() const { return std::as_const(command_).get_options(); }
  // And of the program.
  std::vector<const CLI::Option*> options() const {
    std::vector<const CLI::Option*> options = command_options();
    for (const CLI::Option* option : std::as_const(app_).get_options()) options.push_back(option);
    return options;
  }

  Job& job() { return job_; }
  const Job& job() const { return job_; }

 private:
  CLI::App app_{"", "aerate"};
  ConfigFile config_;
  CLI::App& command_;
  Job job_;
};

// Of a command whose options `Job` adds.
template <typename Job>
std::vector<CalledOption> options_of_command() {
  return called_options(CommandAlone<Job>("command").options());
}

}  // namespace aerate::cli
