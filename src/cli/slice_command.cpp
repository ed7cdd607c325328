#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/ranges.h>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/form_options.h"
#include "cli/model_options.h"
#include "cli/run_reported.h"
#include "cli/view_options.h"
#include "core/error.h"
#include "core/listed.h"
#include "pipeline/slice_model.h"
#include "pipeline/slice_supports.h"

namespace aerate::cli {
namespace {

// As the command line and its help name a slicer.
std::vector<std::string> names_of(const SlicerProfile& slicer) {
  return {slicer.name};
}

std::vector<std::string> described(const SlicerProfile& slicer) {
  if (slicer.untested) return {slicer.name + " (untested)"};
  if (slicer.runs_also.empty()) return {slicer.name};
  return {fmt::format("{} (also {}, by --slicer-path)", slicer.name, slicer.runs_also)};
}

const std::map<std::string, Comparison> kComparisons{
    {"forms", Comparison::forms}, {"lightning", Comparison::lightning}, {"patterns", Comparison::patterns}};

std::vector<std::string> names_of_patterns() {
  std::vector<std::string> names = of_slicers([](const SlicerProfile& slicer) {
    std::vector<std::string> own;
    for (const SparsePattern& pattern : slicer.patterns) own.push_back(pattern.name);
    return own;
  });
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

struct SliceCommand {
  SliceCommand(CLI::App& command, const ConfigFile& config)
      : model(command),
        form(command, config, names_of_patterns()),
        views(command, "what is sliced"),
        run_options(command) {
    command
        .add_option("--compare", comparison,
                    "What is sliced beside solid, voids and modifiers: forms (nothing), lightning (the solid "
                    "model in PrusaSlicer's lightning infill, one more run), or patterns (in all its sparse "
                    "patterns, and modifiers that hold lightning, four more runs)")
        ->check(CLI::IsMember(kComparisons))
        ->type_name("WHAT")
        ->capture_default_str();
    command.add_option("-o,--output", output, "The G-code")->required()->type_name("FILE");
    command.add_option("--slicer", slicer, listed(of_slicers(described), "or"))
        ->required()
        ->check(CLI::IsMember(of_slicers(names_of)))
        ->type_name("NAME");
    command.add_flag(
        "--supports", supports,
        "Instead: make supports as 'aerate support --parts' does, slice the model with them, and compare "
        "with the slicer's own");
    // Of the slicer: the program's own options file has to be named before the command.
    command
        .add_option("--config", settings,
                    fmt::format("The slicer's settings, once for each file: {}",
                                fmt::join(of_slicers(&SlicerProfile::settings), "; ")))
        ->type_name("FILE")
        ->allow_extra_args(false)  // or it would take the model
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  }

  SliceModelOptions to_pipeline() const {
    SliceModelOptions options;
    options.output = output;
    options.slicer = &*std::ranges::find(slicers(), slicer, &SlicerProfile::name);
    options.settings.files.assign(settings.begin(), settings.end());
    options.request = form.request(model);
    options.comparison = kComparisons.at(comparison);
    options.views = views.outputs();
    return options;
  }

  // Throws UsageError for what says how a model is hollowed.
  SliceSupportsOptions with_supports() const {
    SliceModelOptions sliced = to_pipeline();
    if (sliced.request.form || sliced.comparison != Comparison::lightning || sliced.views.are_asked_for())
      throw UsageError("--supports makes no voids: --as, --compare, --picture and --view are for these",
                       "leave them out, or --supports");
    SliceSupportsOptions options;
    options.output = output;
    options.slicer = sliced.slicer;
    options.slicer_path = sliced.request.slicer_path;
    options.settings = sliced.settings;
    const HollowOptions& hollow = sliced.request.hollow;
    options.support.model = hollow.model;
    options.support.load = hollow.load;
    options.support.weld = hollow.weld;
    options.support.process = hollow.packing.process.process;
    options.support.direction = hollow.packing.process.direction;
    for (const Limit limit : {Limit::overhang, Limit::bridge}) {
      const auto chosen = hollow.packing.process.limits.find(limit);
      if (chosen != hollow.packing.process.limits.end() && !is_default(hollow.packing.process, limit))
        options.support.given.insert(*chosen);
    }
    return options;
  }

  void run() const {
    if (supports) {
      const SliceSupportsOptions options = with_supports();
      run_reported(run_options, files(options.output),
                   [&](Monitor& monitor) { return slice_supports(options, monitor); });
      return;
    }
    const SliceModelOptions options = to_pipeline();
    run_reported(run_options, files(options.output),
                 [&](Monitor& monitor) { return slice_model(options, monitor); });
  }

  JobFiles files(const std::filesystem::path& gcode) const {
    JobFiles files{form.inputs(model), {gcode}};
    for (const std::string& file : settings) files.inputs.push_back({"file of settings", file});
    files.add_outputs(views.files());
    return files;
  }

  ModelOptions model;
  FormOptions form;
  ViewOptions views;
  RunOptions run_options;
  std::string output;
  std::string slicer;
  bool supports = false;
  std::string comparison = "lightning";
  std::vector<std::string> settings;
};

}  // namespace

void add_slice_command(CLI::App& app, const ConfigFile& config) {
  CLI::App& command = *app.add_subcommand(
      "slice", "Slice a model solid and hollowed with your settings, and write the better G-code");
  command.callback([job = std::make_shared<SliceCommand>(command, config)] { job->run(); });
}

}  // namespace aerate::cli
