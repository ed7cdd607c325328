#include "cli/form_options.h"

#include <fmt/format.h>

#include "core/error.h"

namespace aerate::cli {

FormOptions::FormOptions(CLI::App& command, const ConfigFile& config)
    : packing_(command, config), modifier_options_(config) {
  add_tolerance(command, tolerance_);
  command
      .add_option("--as", as_,
                  "What is printed: voids, modifiers (see 'aerate hollow --help'), or auto: whichever takes "
                  "the least filament by the slicer's figures, the solid model if neither takes less")
      ->check(CLI::IsMember({"auto", "voids", "modifiers"}))
      ->type_name("FORM")
      ->capture_default_str();
  modifier_options_.add(add_modifier_infill(command, modifier_infill_percent_));
  command.add_option("--slicer-path", slicer_path_, "The slicer's program (default: looked for on the PATH)")
      ->type_name("FILE");
}

FormRequest FormOptions::request(const ModelOptions& model) const {
  if (as_ == "voids") modifier_options_.require_none("with --as voids");
  FormRequest request;
  request.slicer_path = slicer_path_;
  if (as_ != "auto") request.form = as_ == "voids" ? PrintForm::voids : PrintForm::modifiers;
  request.modifier_infill_percent = modifier_infill_percent_;
  HollowOptions& options = request.hollow;
  options.model = model.path;
  options.load = model.load();
  options.weld = model.weld;
  options.packing = packing_.request();
  const Process& process = options.packing.process.process;
  if (process.drainage == Drainage::needed)
    throw UsageError(
        fmt::format("process {} prints no filament, and these slicers do nothing else", process.name),
        "make a model with voids that drain by 'aerate hollow', and open it in the slicer of your printer");
  options.tolerance = tolerance_;
  require_tolerance_for(options.packing.process, tolerance_);
  return request;
}

}  // namespace aerate::cli
