#include "cli/pack_command.h"

#include <CLI/CLI.hpp>
#include <string>

#include "cli/model_options.h"
#include "cli/run_reported.h"
#include "pipeline/pack.h"

namespace aerate::cli {

struct PackCommand::Options {
  Options(CLI::App& app, const ConfigFile& config)
      : command(*app.add_subcommand("pack", "Pack spheres in a closed model and write them as a table")),
        model(command),
        packing(command, config),
        run(command) {
    command
        .add_option("-o,--output", output,
                    "The spheres: .csv (a line x,y,z,radius,kind each), .json or .ply (required)")
        ->required()
        ->type_name("FILE");
  }

  CLI::App& command;
  ModelOptions model;
  PackingCommandOptions packing;
  RunOptions run;
  std::string output;
};

PackCommand::PackCommand(CLI::App& app, const ConfigFile& config)
    : options_(std::make_unique<Options>(app, config)) {}
PackCommand::~PackCommand() = default;

bool PackCommand::chosen() const {
  return options_->command.parsed();
}

void PackCommand::run(InterruptGuard& interrupt) const {
  PackOptions options;
  options.model = options_->model.path;
  options.output = options_->output;
  options.load = options_->model.load();
  options.packing = options_->packing.request();
  run_reported(options_->run, {options.model, options.output}, interrupt,
               [&](Monitor& monitor) { return pack(options, monitor); });
}

}  // namespace aerate::cli
