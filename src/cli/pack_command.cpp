#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/model_options.h"
#include "cli/run_reported.h"
#include "pipeline/pack.h"

namespace aerate::cli {
namespace {

struct PackCommand {
  PackCommand(CLI::App& command, const ConfigFile& config)
      : model(command), packing(command, config), run_options(command) {
    command
        .add_option("-o,--output", output,
                    "The spheres: .csv (a line x,y,z,radius,kind each), .json or .ply (required)")
        ->required()
        ->type_name("FILE");
  }

  void run() const {
    PackOptions options;
    options.model = model.path;
    options.output = output;
    options.load = model.load();
    options.weld = model.weld;
    options.packing = packing.request();
    JobFiles files{packing.inputs(model.path), {options.output}};
    run_reported(run_options, files, [&](Monitor& monitor) { return pack(options, monitor); });
  }

  ModelOptions model;
  PackingCommandOptions packing;
  RunOptions run_options;
  std::string output;
};

}  // namespace

void add_pack_command(CLI::App& app, const ConfigFile& config) {
  CLI::App& command = *app.add_subcommand("pack", "Pack spheres in a closed model and write them as a table");
  command.callback([job = std::make_shared<PackCommand>(command, config)] { job->run(); });
}

}  // namespace aerate::cli
