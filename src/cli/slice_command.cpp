#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/form_options.h"
#include "cli/model_options.h"
#include "cli/run_reported.h"
#include "pipeline/slice_model.h"

namespace aerate::cli {
namespace {

struct SliceCommand {
  SliceCommand(CLI::App& command, const ConfigFile& config)
      : model(command), form(command, config), run_options(command) {
    command.add_option("-o,--output", output, "The G-code (required)")->required()->type_name("FILE");
    command
        .add_option(
            "--slicer", slicer,
            "prusa-slicer (also SuperSlicer, by --slicer-path), orca-slicer (untested), cura-engine or "
            "slic3r (required)")
        ->required()
        ->check(CLI::IsMember({"prusa-slicer", "orca-slicer", "cura-engine", "slic3r"}))
        ->type_name("NAME");
    // Of the slicer: the program's own options file has to be named before the command.
    command
        .add_option(
            "--config", settings,
            "The slicer's settings, once for each file: .ini or G-code (PrusaSlicer, Slic3r); JSON of "
            "machine, process and filament (OrcaSlicer); .def.json and lines name=value (CuraEngine)")
        ->type_name("FILE")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  }

  SliceModelOptions to_pipeline() const {
    SliceModelOptions options;
    options.output = output;
    options.slicer = std::map<std::string, SlicerKind>{{"prusa-slicer", SlicerKind::prusa_slicer},
                                                       {"orca-slicer", SlicerKind::orca_slicer},
                                                       {"cura-engine", SlicerKind::cura_engine},
                                                       {"slic3r", SlicerKind::slic3r}}
                         .at(slicer);
    options.slicer_path = form.slicer_path;
    options.settings.files.assign(settings.begin(), settings.end());
    options.form = form.choice();
    options.modifier_infill_percent = form.modifier_infill_percent;
    options.hollow = form.hollow(model);
    return options;
  }

  void run() const {
    const SliceModelOptions options = to_pipeline();
    run_reported(run_options, {options.hollow.model, options.output},
                 [&](Monitor& monitor) { return slice_model(options, monitor); });
  }

  ModelOptions model;
  FormOptions form;
  RunOptions run_options;
  std::string output;
  std::string slicer;
  std::vector<std::string> settings;
};

}  // namespace

void add_slice_command(CLI::App& app, const ConfigFile& config) {
  CLI::App& command = *app.add_subcommand(
      "slice", "Slice a model solid and hollowed with your settings, and write the better G-code");
  command.callback([job = std::make_shared<SliceCommand>(command, config)] { job->run(); });
}

}  // namespace aerate::cli
