#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>

#include "cli/called_commands.h"
#include "cli/command_alone.h"
#include "cli/commands.h"
#include "cli/drainage_options.h"
#include "cli/model_options.h"
#include "cli/numbers.h"
#include "cli/process_options.h"
#include "cli/run_reported.h"
#include "cli/view_options.h"
#include "core/error.h"
#include "pipeline/inspect_model.h"

namespace aerate::cli {
namespace {

struct InspectCommand {
  InspectCommand(CLI::App& command, const ConfigFile& config_file)
      : config(config_file),
        model(command),
        process_option(add_process_option(command, process,
                                          "with --drainage (default sla) and --overhangs (default fdm)")),
        up(command, config_file),
        limits(command, config_file),
        build(command),
        views(command, "the model, with what is wrong at its place"),
        run_options(command) {
    command.add_flag("--self-intersections", self_intersections,
                     "Also look for triangles that intersect each other (slow for large models)");
    command.add_flag("--drainage", drainage,
                     "Also find out how it drains, whoever hollowed it: sealed cavities, holes, what stays, "
                     "suction, the thinnest wall");
    command.add_flag(
        "--overhangs", overhangs,
        "Also find out what cannot be printed without supports: what leans out further than the "
        "overhang angle and is farther from what holds it than half a bridge, and what begins in "
        "the air");
    command
        .add_option("--widest-hole", widest_hole,
                    "With --drainage: what is wider belongs to the outside, mm (default twice the process's "
                    "escape holes)")
        ->check(number_between({}, kLongest, "mm"))
        ->type_name("MM");
  }

  // Throws UsageError for options that say how it drains if that is not asked for.
  std::optional<DrainageInquiry> inquiry() const {
    if (drainage)
      return DrainageInquiry{choose_process(process_or("sla")), up.direction(), build.build(), widest_hole};
    if (build.is_given() || widest_hole)
      throw UsageError("--build and --widest-hole are for --drainage", "add --drainage");
    if (!overhangs && (process_option->count() > 0 || up.is_given()))
      throw UsageError("--process and --up are for --drainage and --overhangs", "add one of them");
    return std::nullopt;
  }

  std::string process_or(const char* other) const { return process.empty() ? other : process; }

  std::optional<OverhangInquiry> overhang_inquiry() const {
    if (overhangs) return OverhangInquiry{choose_process(process_or("fdm")), up.direction(), limits.given()};
    if (limits.are_given())
      throw UsageError("--overhang and --bridge are for --overhangs", "add --overhangs");
    return std::nullopt;
  }

  InspectOptions to_pipeline() const {
    InspectOptions options;
    options.drainage = inquiry();
    options.overhangs = overhang_inquiry();
    options.model = model.path;
    options.load = model.load();
    options.weld = model.weld;
    options.views = views.outputs();
    if (self_intersections) options.self_intersections = SelfIntersectionSearch::on;
    return options;
  }

  JobFiles files() const {
    JobFiles files{{{"model", model.path}, {"configuration file", config.path()}}, {}};
    if ((drainage || overhangs) && !process.empty())
      files.inputs.push_back({"process file", process_file_of(process)});
    files.add_outputs(views.files());
    return files;
  }

  void run() const {
    const InspectOptions options = to_pipeline();
    run_reported(run_options, files(), [&](Monitor& monitor) { return inspect_model(options, monitor); });
  }

  const ConfigFile& config;
  ModelOptions model;
  std::string process;  // the question's own if empty
  const CLI::Option* process_option;
  DirectionOption up;
  OverhangOptions limits;
  BuildOption build;
  ViewOptions views;
  RunOptions run_options;
  bool drainage = false;
  bool overhangs = false;
  std::optional<double> widest_hole;
  bool self_intersections = false;
};

CalledResult call_inspect(const Call& call, Monitor& monitor) {
  const CommandAlone<InspectCommand> alone("inspect", call);
  const InspectCommand& command = alone.job();
  InspectOptions options = command.to_pipeline();
  options.arrays = call.arrays;
  CalledResult result;
  run_called(command.run_options, command.files(), call,
             [&] { result.report = to_json(inspect_model(options, monitor)); });
  return result;
}

}  // namespace

CalledCommand called_inspect() {
  return {"inspect", options_of_command<InspectCommand>, call_inspect};
}

void add_inspect_command(CLI::App& app, const ConfigFile& config) {
  CLI::App& command = *app.add_subcommand("inspect", "Tell what is right and wrong with a model");
  command.callback([job = std::make_shared<InspectCommand>(command, config)] { job->run(); });
}

}  // namespace aerate::cli
