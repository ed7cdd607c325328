#include "cli/form_options.h"

#include <fmt/format.h>
#include <map>

#include "cli/numbers.h"
#include "core/error.h"

namespace aerate::cli {

FormOptions::FormOptions(CLI::App& command, const ConfigFile& config) : packing_(command, config) {
  command.add_option("--tolerance", tolerance_, "Void surfaces stay this far inside their spheres at most")
      ->check(number_between({}, kLongest, "mm"))
      ->type_name("MM")
      ->capture_default_str();
  command
      .add_option("--as", as_,
                  "What is printed: voids, modifiers (see 'aerate hollow --help'), or auto: whichever takes "
                  "the least filament by the slicer's figures, the solid model if neither takes less")
      ->check(CLI::IsMember({"auto", "voids", "modifiers"}))
      ->type_name("FORM")
      ->capture_default_str();
  command.add_option("--modifier-infill", modifier_infill_percent, "Infill inside modifiers")
      ->check(number_between(0.0, 100, "%"))
      ->type_name("PERCENT")
      ->capture_default_str();
  command.add_option("--slicer-path", slicer_path, "The slicer's program (default: looked for on the PATH)")
      ->type_name("FILE");
}

HollowOptions FormOptions::hollow(const ModelOptions& model) const {
  HollowOptions options;
  options.model = model.path;
  options.load = model.load();
  options.packing = packing_.request();
  options.tolerance = tolerance_;
  if (tolerance_ > options.packing.limits.min_radius / 2) {
    throw UsageError(fmt::format("--tolerance {} mm is more than half of --min-radius {} mm", tolerance_,
                                 options.packing.limits.min_radius),
                     "give a smaller --tolerance or a larger --min-radius");
  }
  return options;
}

FormChoice FormOptions::choice() const {
  return std::map<std::string, FormChoice>{
      {"auto", FormChoice::automatic}, {"voids", FormChoice::voids}, {"modifiers", FormChoice::modifiers}}
      .at(as_);
}

}  // namespace aerate::cli
