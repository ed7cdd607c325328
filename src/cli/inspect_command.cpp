#include "cli/inspect_command.h"

#include <CLI/CLI.hpp>

#include "cli/model_options.h"
#include "cli/run_reported.h"
#include "pipeline/inspect_model.h"

namespace aerate::cli {

struct InspectCommand::Options {
  explicit Options(CLI::App& app)
      : command(*app.add_subcommand("inspect", "Tell what is right and wrong with a model")),
        model(command),
        run(command) {
    command.add_flag("--self-intersections", self_intersections,
                     "Also look for triangles that intersect each other (slow for large models)");
  }

  CLI::App& command;
  ModelOptions model;
  RunOptions run;
  bool self_intersections = false;
};

InspectCommand::InspectCommand(CLI::App& app) : options_(std::make_unique<Options>(app)) {}
InspectCommand::~InspectCommand() = default;

bool InspectCommand::chosen() const {
  return options_->command.parsed();
}

void InspectCommand::run(InterruptGuard& interrupt) const {
  InspectOptions options;
  options.model = options_->model.path;
  options.load = options_->model.load();
  if (options_->self_intersections) options.self_intersections = SelfIntersectionSearch::on;
  run_reported(options_->run, {options.model}, interrupt,
               [&](Monitor& monitor) { return inspect_model(options, monitor); });
}

}  // namespace aerate::cli
