#include "cli/print_options.h"

#include <algorithm>
#include <fmt/format.h>
#include <string>
#include <string_view>

#include "cli/numbers.h"
#include "core/error.h"

namespace aerate::cli {
namespace {

constexpr const char* kGroup = "The print, for filament";

// "15" or "15%", as a share.
std::optional<double> parse_percent(std::string_view text) {
  if (text.ends_with('%')) text.remove_suffix(1);
  const std::optional<double> percent = parse_number(text);
  if (!percent || *percent < 0 || *percent > 100) return {};
  return *percent / 100;
}

}  // namespace

PrintOptions::PrintOptions(CLI::App& command) {
  infill_option_ =
      command
          .add_option(
              "--infill", infill_,
              "Infill of the print; with it filament is predicted, voids that would cost more than they save "
              "are left out, and a print that would become heavier is refused (default: figures are for "
              "solid "
              "material, and for 15 % around modifiers)")
          ->check(parsed_by(parse_percent, "is not a share from 0% to 100%"))
          ->type_name("PERCENT")
          ->group(kGroup);
  options_.push_back(infill_option_);
  const auto add = [&](const char* name, auto& value, const char* what) {
    CLI::Option* option = command.add_option(name, value, what)->group(kGroup)->capture_default_str();
    options_.push_back(option);
    return option;
  };
  add("--infill-pattern", pattern_, "gyroid, or lines for any pattern of straight lines")
      ->check(CLI::IsMember({"gyroid", "lines"}))
      ->type_name("PATTERN");
  add("--perimeters", settings_.perimeters, "Lines along each contour")
      ->check(CLI::Range(0, 100))
      ->type_name("N");
  add("--line-width", settings_.line_width, "Width of an extruded line")
      ->check(number_between({}, 10, "mm"))
      ->type_name("MM");
  add("--layer-height", settings_.layer_height, "Height of a layer")
      ->check(number_between(0.01, 10, "mm"))
      ->type_name("MM");
  add("--top-layers", settings_.top_layers, "Solid layers under surfaces that look up")
      ->check(CLI::Range(0, 1000))
      ->type_name("N");
  add("--bottom-layers", settings_.bottom_layers, "Solid layers over surfaces that look down")
      ->check(CLI::Range(0, 1000))
      ->type_name("N");
  command.add_flag("--force", force_, "Write the model even if its print becomes heavier")
      ->needs(infill_option_)
      ->group(kGroup);
}

const CLI::Option* PrintOptions::given() const {
  const auto found = std::ranges::find_if(options_, [](const auto* option) { return option->count() > 0; });
  return found == options_.end() ? nullptr : *found;
}

PrintSettings PrintOptions::settings(const Process& process) const {
  const CLI::Option* const described = given();
  if (described != nullptr && process.drainage == Drainage::needed) {
    throw UsageError(fmt::format("{} {} contradicts --process {}, which prints solid material",
                                 described->get_name(), described->results().front(), process.name),
                     "leave one of them out");
  }
  PrintSettings settings = settings_;
  if (knows_infill()) settings.infill = parse_percent(infill_).value();
  settings.pattern = pattern_ == "gyroid" ? InfillPattern::gyroid : InfillPattern::lines;
  return settings;
}

void PrintOptions::require_lines_that_fit(const PackingLimits& limits) const {
  if (given() == nullptr) return;
  const PrintSettings& settings = settings_;
  if (settings.layer_height > settings.line_width) {
    throw UsageError(fmt::format("--layer-height {:g} mm is more than --line-width {:g} mm",
                                 settings.layer_height, settings.line_width),
                     "a line is wider than it is high");
  }
  const auto require = [&](double thickness, const char* option) {
    if (thickness < settings.line_width) {
      throw UsageError(
          fmt::format("{} {:g} mm is less than --line-width {:g} mm", option, thickness, settings.line_width),
          fmt::format("nothing thinner than a line can be printed: give a larger {}", option));
    }
  };
  require(limits.wall, "--wall");
  require(limits.gap, "--gap");
}

}  // namespace aerate::cli
