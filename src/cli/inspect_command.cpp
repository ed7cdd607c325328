#include <CLI/CLI.hpp>
#include <memory>

#include "cli/commands.h"
#include "cli/model_options.h"
#include "cli/run_reported.h"
#include "pipeline/inspect_model.h"

namespace aerate::cli {
namespace {

struct InspectCommand {
  InspectCommand(CLI::App& command, const ConfigFile& config_file)
      : config(config_file), model(command), run_options(command) {
    command.add_flag("--self-intersections", self_intersections,
                     "Also look for triangles that intersect each other (slow for large models)");
  }

  void run() const {
    InspectOptions options;
    options.model = model.path;
    options.load = model.load();
    options.weld = model.weld;
    if (self_intersections) options.self_intersections = SelfIntersectionSearch::on;
    run_reported(run_options, {{{"model", options.model}, {"configuration file", config.path()}}, {}},
                 [&](Monitor& monitor) { return inspect_model(options, monitor); });
  }

  const ConfigFile& config;
  ModelOptions model;
  RunOptions run_options;
  bool self_intersections = false;
};

}  // namespace

void add_inspect_command(CLI::App& app, const ConfigFile& config) {
  CLI::App& command = *app.add_subcommand("inspect", "Tell what is right and wrong with a model");
  command.callback([job = std::make_shared<InspectCommand>(command, config)] { job->run(); });
}

}  // namespace aerate::cli
