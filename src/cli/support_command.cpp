#include <CLI/CLI.hpp>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/model_options.h"
#include "cli/numbers.h"
#include "cli/process_options.h"
#include "cli/run_reported.h"
#include "cli/support_foam.h"
#include "cli/view_options.h"
#include "core/error.h"
#include "files/formats.h"
#include "pipeline/support.h"

namespace aerate::cli {
namespace {

const std::map<std::string, Fill> kFills{
    {"plain", Fill::plain}, {"spheres", Fill::spheres}, {"cells", Fill::cells}};

// Slicers that have a format for parts, by what it is called.
std::map<std::string, const SlicerProfile*> flavors() {
  std::map<std::string, const SlicerProfile*> known;
  for (const SlicerProfile& slicer : slicers())
    if (slicer.modifiers && !slicer.modifiers->support_settings.empty())
      known[slicer.modifiers->flavor] = &slicer;
  return known;
}

struct SupportCommand {
  SupportCommand(CLI::App& command, const ConfigFile& config_file)
      : config(config_file),
        model(command),
        process_option(
            add_process_option(command, process, "says what needs supports, and how they are made")),
        up(command, config_file),
        limits(command, config_file),
        views(command, "the model and its supports"),
        run_options(command) {
    command
        .add_option("-o,--output", output,
                    fmt::format("The supports alone, {}; with --parts model and supports, .3mf",
                                endings_that_are_written()))
        ->required()
        ->check(names_a_file())
        ->type_name("FILE");
    command
        .add_option("--clearance", clearance,
                    "What the body leaves free between itself and the model (default 0.8)")
        ->check(number_between({}, 20, "mm"))
        ->type_name("MM");
    command
        .add_option(
            "--contact-gap", contact_gap,
            "What teeth leave free below what they hold, and above what they stand on, in whole layers; 0: "
            "they are joined to it (default 0.2 for fdm, else 0)")
        ->check(number_between(0.0, 5, "mm"))
        ->type_name("MM");
    command
        .add_option(
            "--tooth", tooth,
            "Width of what touches the model: of ridges (default 0.5), for resin and metal of flat tips "
            "(default 0.4); at least a line or a pixel, and no wider than the body under a single one")
        ->check(number_between(0.05, 1.5, "mm"))
        ->type_name("MM");
    command
        .add_option("--stem", stem,
                    "Width that the body is not drawn in below on its way down (default 4 and, where "
                    "voids drain, no less than a channel and a wall take); 200: straight down")
        ->check(number_between(1.0, 200, "mm"))
        ->type_name("MM");
    command
        .add_option("--leave", leave,
                    "Area of overhangs, seen from above, that may be left without a tooth where none has "
                    "room; with more nothing is "
                    "written (default 1)")
        ->check(number_between(0.0, 1e6, "mm2"))
        ->type_name("MM2");
    command.add_option("--layer-height", layer_height, "Of the print (default 0.2 for fdm, else 0.05)")
        ->check(number_between(0.01, 1, "mm"))
        ->type_name("MM");
    command.add_option("--plate", plate, "Height of the plate along --up (default the model's lowest point)")
        ->check(number_between(-kLongest, kLongest, "mm"))
        ->type_name("MM");
    command
        .add_option(
            "--fill", fill,
            "Voids in the body: plain (none; print it with one perimeter and no infill), spheres or cells "
            "(default plain for fdm, else cells)")
        ->check(CLI::IsMember(kFills))
        ->type_name("WHAT");
    command
        .add_option("--parts", parts,
                    "Write the model with the supports as a part of its own that this slicer prints with the "
                    "settings "
                    "that took least: prusa or orca; the slicer's own supports are off for it")
        ->check(CLI::IsMember(flavors()))
        ->type_name("SLICER");
    command.add_option("--extruder", extruder, "With --parts: the extruder that prints the supports, from 1")
        ->check(whole_number_between(1, 16, ""))
        ->type_name("N");
  }

  SupportOptions to_pipeline() const {
    SupportOptions options;
    options.model = model.path;
    options.output = output;
    options.load = model.load();
    options.weld = model.weld;
    options.process = choose_process(process);
    options.direction = up.direction();
    options.given = limits.given();
    options.stem = stem;
    options.views = views.outputs();
    options.clearance = clearance;
    options.contact_gap = contact_gap;
    options.tooth = tooth;
    options.layer_height = layer_height;
    if (leave) options.most_left = *leave;
    options.plate = plate;
    if (!parts.empty()) options.parts_for = flavors().at(parts);
    if (extruder && parts.empty())
      throw UsageError("--extruder is for supports that are a part", "add --parts prusa or --parts orca");
    if (extruder) options.extruder = static_cast<int>(*extruder);
    const bool is_filament = options.process.drainage == Drainage::not_needed;
    const bool is_plain_unasked = is_filament || options.parts_for != nullptr;
    const Fill what = !fill.empty() ? kFills.at(fill) : is_plain_unasked ? Fill::plain : Fill::cells;
    if (what != Fill::plain)
      options.foam = [what, name = process, given = options.given, is_asked = !fill.empty()](
                         const Mesh& body, const MayOpen& may_open, Monitor& monitor) {
        try {
          return foamed(body, what, name, given, may_open, monitor);
        } catch (const Error& error) {
          if (error.code() != ExitCode::nothing_to_remove) throw;
          if (is_asked)
            throw NothingToRemoveError(std::string("no voids can be made in the body: ") + error.what(),
                                       "leave out --fill for a plain body, or give a larger --stem");
          monitor.notice(std::string("the body stays plain: ") + error.what());
          return FoamedBody{body, ""};
        }
      };
    return options;
  }

  JobFiles files() const {
    JobFiles files{{{"model", model.path},
                    {"configuration file", config.path()},
                    {"process file", process_file_of(process)}},
                   {output}};
    files.add_outputs(views.files());
    return files;
  }

  void run() const {
    const SupportOptions options = to_pipeline();
    run_reported(run_options, files(), [&](Monitor& monitor) { return support_model(options, monitor); });
  }

  const ConfigFile& config;
  ModelOptions model;
  std::string process = "fdm";
  const CLI::Option* process_option;
  DirectionOption up;
  OverhangOptions limits;
  ViewOptions views;
  RunOptions run_options;
  std::string output;
  std::optional<double> clearance, contact_gap, tooth, stem, leave, layer_height, plate;
  std::string fill, parts;
  std::optional<double> extruder;
};

}  // namespace

void add_support_command(CLI::App& app, const ConfigFile& config) {
  CLI::App& command =
      *app.add_subcommand("support", "Make supports that break away for what hangs over, and write them");
  command.callback([job = std::make_shared<SupportCommand>(command, config)] { job->run(); });
}

}  // namespace aerate::cli
