#include "cli/called_commands.h"

#include <CLI/CLI.hpp>
#include <array>
#include <utility>

#include "cli/command_alone.h"
#include "cli/json_parts.h"
#include "cli/model_options.h"

namespace aerate::cli {
namespace {

struct LoadCommand {
  LoadCommand(CLI::App& command, const ConfigFile& /*config*/) : model(command) {
    command.remove_option(command.get_option("--weld"));  // which the other commands do
    command.fallthrough();
  }

  ModelOptions model;
};

CalledResult call_load(const Call& call, Monitor& monitor) {
  const CommandAlone<LoadCommand> alone("load", call);
  monitor.stage("load");
  const LoadOptions options = alone.job().model.load();
  LoadedModel loaded = call.arrays != nullptr ? load_model(*call.arrays, call.model.string(), options)
                                              : load_model(call.model, options);
  monitor.check_interrupted();
  const Json facts{{"format", loaded.format}, {"parts", loaded.part_count}, {"notices", loaded.notices}};
  return {.report = dump(facts), .spheres = {}, .mesh = std::move(loaded.mesh)};
}

}  // namespace

std::span<const CalledCommand> called_commands() {
  static const std::array kCommands{CalledCommand{"load", options_of_command<LoadCommand>, call_load},
                                    called_inspect(), called_pack(), called_hollow()};
  return kCommands;
}

}  // namespace aerate::cli
