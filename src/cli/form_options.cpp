#include "cli/form_options.h"

#include <fmt/format.h>
#include <map>
#include <utility>

#include "core/error.h"

namespace aerate::cli {

namespace {

const std::map<std::string, PrintForm> kForms{{"voids", PrintForm::voids},
                                              {"modifiers", PrintForm::modifiers},
                                              {"lightning-modifiers", PrintForm::lightning_modifiers}};

CellWords words_of_print_cells() {
  return {
      .shape =
          "What voids and modifiers are: the packed spheres, or the cells round them (default cells for "
          "modifiers; for voids whichever take less filament, where what the print is can be read from "
          "the slicer's G-code, else spheres)",
      .fillet = "1",
      .tolerance = "Void surfaces stay this far inside their shapes at most (default 0.05, of cells 0.1)"};
}

}  // namespace

FormOptions::FormOptions(CLI::App& command, const ConfigFile& config,
                         const std::vector<std::string>& patterns)
    : packing_(command, config), cells_(command, words_of_print_cells()), modifier_options_(config) {
  std::vector<std::string> forms{"auto"};
  for (const auto& [name, form] : kForms) forms.push_back(name);
  forms.insert(forms.end(), patterns.begin(), patterns.end());
  command
      .add_option(
          "--as", as_,
          fmt::format("What is printed: voids, modifiers (see 'aerate hollow --help'), modifiers that "
                      "hold the slicer's lightning infill{}, or auto: voids or modifiers, whichever "
                      "take the least filament by the slicer's figures, the solid model if neither "
                      "takes less",
                      patterns.empty() ? "" : ", the solid model in a pattern of the slicer"))
      ->check(CLI::IsMember(forms))
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
  if (const auto form = kForms.find(as_); form != kForms.end()) {
    request.form = form->second;
  } else if (as_ != "auto") {
    request.form = PrintForm::pattern;
    request.pattern = as_;
  }
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
  request.voids = voids(options);
  request.modifiers = modifiers(options);
  return request;
}

HollowOptions FormOptions::shaped(HollowOptions options, bool makes_cells) const {
  ShapedRequest shaped = cells_.applied_to(std::move(options.packing), makes_cells, CellOptions{}.fillet);
  options.packing = std::move(shaped.packing);
  options.cells = shaped.cells;
  options.tolerance = shaped.tolerance.value_or(options.tolerance);
  require_tolerance_for(options.packing.process, options.tolerance);
  return options;
}

// Spheres, and cells where nobody said what voids are.
std::vector<HollowOptions> FormOptions::voids(const HollowOptions& options) const {
  const std::optional<bool> asked = cells_.asks_for_cells();
  if (asked || cells_.says_how_cells_are()) return {shaped(options, asked.value_or(true))};
  std::vector<HollowOptions> forms{shaped(options, false)};
  if (!may_be_cells(options.packing)) return forms;
  try {
    forms.push_back(shaped(options, true));
  } catch (const UsageError&) {
    // These options leave no choice.
  }
  return forms;
}

HollowOptions FormOptions::modifiers(const HollowOptions& options) const {
  const std::optional<bool> asked = cells_.asks_for_cells();
  if (asked || !may_be_cells(options.packing)) return shaped(options, asked.value_or(false));
  try {
    return shaped(options, true);
  } catch (const UsageError&) {
    if (cells_.says_how_cells_are()) throw;
    return shaped(options, false);
  }
}

}  // namespace aerate::cli
