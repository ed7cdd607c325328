#include "cli/print_options.h"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <string>
#include <string_view>
#include <utility>

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

const char* name_of(PrintSetting setting) {
  switch (setting) {
    case PrintSetting::infill:
      return "infill";
    case PrintSetting::pattern:
      return "infill_pattern";
    case PrintSetting::perimeters:
      return "perimeters";
    case PrintSetting::line_width:
      return "line_width";
    case PrintSetting::layer_height:
      return "layer_height";
    case PrintSetting::top_layers:
      return "top_layers";
    case PrintSetting::bottom_layers:
      return "bottom_layers";
    case PrintSetting::slicer_version:
      return "slicer_version";
    case PrintSetting::vertical_shells:
      return "vertical_shells";
    case PrintSetting::walls:
      return "wall_generator";
  }
  return "unknown";
}

// Those that decide whose rules hold are told where they were given alone.
bool is_of_rules(PrintSetting setting) {
  return setting == PrintSetting::slicer_version || setting == PrintSetting::vertical_shells ||
         setting == PrintSetting::walls;
}

const char* name_of(VerticalShells shells) {
  switch (shells) {
    case VerticalShells::enabled:
      return "enabled";
    case VerticalShells::partial:
      return "partial";
    case VerticalShells::disabled:
      return "disabled";
  }
  return "unknown";
}

std::string in_words(PrintSetting setting, const HollowOptions& options) {
  const PrintSettings& print = options.print;
  switch (setting) {
    case PrintSetting::infill:
      return options.infill_is_known ? fmt::format("infill {:g} %", 100 * print.infill) : "infill not known";
    case PrintSetting::pattern:
      return print.pattern == InfillPattern::gyroid ? "gyroid" : "lines";
    case PrintSetting::perimeters:
      return fmt::format("{} {}", print.perimeters, print.perimeters == 1 ? "perimeter" : "perimeters");
    case PrintSetting::line_width:
      return fmt::format("lines of {:.4g} mm", print.line_width);
    case PrintSetting::layer_height:
      return fmt::format("layers of {:g} mm", print.layer_height);
    case PrintSetting::top_layers:
      return fmt::format("{} top", print.top_layers);
    case PrintSetting::bottom_layers:
      return fmt::format("{} bottom", print.bottom_layers);
    case PrintSetting::slicer_version:
      return print.rules == SolidRules::prusa_2_5 ? "rules of PrusaSlicer 2.5"
                                                  : "rules of PrusaSlicer 2.6 to 2.9";
    case PrintSetting::vertical_shells:
      return fmt::format("vertical shells {}", name_of(print.vertical_shells));
    case PrintSetting::walls:
      return print.walls == WallGenerator::classic ? "classic walls" : "Arachne's walls";
  }
  return "";
}

}  // namespace

PrintOptions::PrintOptions(CLI::App& command, const ConfigFile& config) : config_(config) {
  const auto add = [&](PrintSetting setting, const char* name, auto& value, const char* what) {
    CLI::Option* option = command.add_option(name, value, what)->group(kGroup);
    rows_.push_back({setting, option});
    return option;
  };
  add(PrintSetting::infill, "--infill", infill_,
      "Infill of the print; with it filament is predicted, voids that would cost more than they save "
      "are left out, and a print that would become heavier is refused (default: figures are for "
      "solid "
      "material, and for 15 % around modifiers)")
      ->check(parsed_by(parse_percent, "is not a share from 0% to 100%"))
      ->type_name("PERCENT");
  add(PrintSetting::pattern, "--infill-pattern", pattern_,
      "gyroid, or lines for any pattern of straight lines")
      ->check(CLI::IsMember({"gyroid", "lines"}))
      ->type_name("PATTERN")
      ->capture_default_str();
  add(PrintSetting::perimeters, "--perimeters", settings_.perimeters, "Lines along each contour")
      ->check(CLI::Range(0, 100))
      ->type_name("N")
      ->capture_default_str();
  add(PrintSetting::line_width, "--line-width", settings_.line_width,
      "Width of an extruded line; if it is given, wall and gap of fdm are by default three and two of them")
      ->check(number_between({}, 10, "mm"))
      ->type_name("MM")
      ->capture_default_str();
  add(PrintSetting::layer_height, "--layer-height", settings_.layer_height, "Height of a layer")
      ->check(number_between(0.01, 10, "mm"))
      ->type_name("MM")
      ->capture_default_str();
  add(PrintSetting::top_layers, "--top-layers", settings_.top_layers,
      "Solid layers under surfaces that look up")
      ->check(CLI::Range(0, 1000))
      ->type_name("N")
      ->capture_default_str();
  add(PrintSetting::bottom_layers, "--bottom-layers", settings_.bottom_layers,
      "Solid layers over surfaces that look down")
      ->check(CLI::Range(0, 1000))
      ->type_name("N")
      ->capture_default_str();
  add(PrintSetting::slicer_version, "--slicer-version", version_,
      "Version of PrusaSlicer, whose rules of solid infill changed in 2.6")
      ->check(parsed_by(parse_version, "is not a version such as 2.9"))
      ->type_name("VERSION")
      ->capture_default_str();
  add(PrintSetting::vertical_shells, "--vertical-shells", shells_,
      "\"Ensure vertical shell thickness\" of PrusaSlicer 2.9")
      ->check(CLI::IsMember({"enabled", "partial", "disabled"}))
      ->type_name("WHICH")
      ->capture_default_str();
  add(PrintSetting::walls, "--wall-generator", walls_, "arachne or classic")
      ->check(CLI::IsMember({"arachne", "classic"}))
      ->type_name("WHICH")
      ->capture_default_str();
  file_option_ = command
                     .add_option("--print-settings", file_,
                                 "Take these from a slicer's file where they are not given: settings "
                                 "that it exported (.ini "
                                 "of PrusaSlicer, SuperSlicer or Slic3r, JSON of OrcaSlicer or Bambu "
                                 "Studio), G-code, or a project "
                                 "(3MF)")
                     ->type_name("FILE")
                     ->group(kGroup);
  command.add_flag("--force", force_, "Write the model even if its print becomes heavier")->group(kGroup);
}

const CLI::Option* PrintOptions::given() const {
  if (file_option_->count() > 0) return file_option_;
  const auto found = std::ranges::find_if(rows_, [](const Row& row) { return row.option->count() > 0; });
  return found == rows_.end() ? nullptr : found->option;
}

const CLI::Option& PrintOptions::option_for(PrintSetting setting) const {
  return *std::ranges::find(rows_, setting, &Row::setting)->option;
}

FoundPrintSettings PrintOptions::read() const {
  KnownPrintSettings known{settings_, {}};
  for (const Row& row : rows_)
    if (row.option->count() > 0) known.which.insert(row.setting);
  if (known.which.contains(PrintSetting::infill)) known.settings.infill = parse_percent(infill_).value();
  if (known.which.contains(PrintSetting::pattern))
    known.settings.pattern = pattern_ == "gyroid" ? InfillPattern::gyroid : InfillPattern::lines;
  if (known.which.contains(PrintSetting::slicer_version))
    known.settings.rules = rules_of(parse_version(version_).value());
  if (known.which.contains(PrintSetting::vertical_shells))
    known.settings.vertical_shells = parse_vertical_shells(shells_).value();
  if (known.which.contains(PrintSetting::walls)) known.settings.walls = parse_walls(walls_).value();
  if (file_option_->count() > 0) return read_print_settings(file_, known);
  return {known.settings, {}, {}};
}

PrintOrigin PrintOptions::origin_of(PrintSetting setting, const FoundPrintSettings& found,
                                    const HollowOptions& options) const {
  PrintOrigin origin{name_of(setting), in_words(setting, options), "default", ""};
  const CLI::Option& option = option_for(setting);
  if (option.count() > 0) {
    origin.origin = config_.origin_of(option);
  } else if (const auto in_file = found.keys.find(setting); in_file != found.keys.end()) {
    origin.origin = std::filesystem::path(file_).filename().string();
    origin.key = in_file->second;
  }
  return origin;
}

HollowOptions PrintOptions::applied_to(HollowOptions options) const {
  const Process& process = options.packing.process.process;
  const CLI::Option* const described = given();
  if (described != nullptr && process.drainage == Drainage::needed) {
    throw UsageError(fmt::format("{} {} contradicts --process {}, which prints solid material",
                                 described->get_name(), described->results().front(), process.name),
                     "leave one of them out");
  }
  FoundPrintSettings found = read();
  const auto is_known = [&](PrintSetting setting) {
    return option_for(setting).count() > 0 || found.keys.contains(setting);
  };
  options.print = found.settings;
  options.infill_is_known = is_known(PrintSetting::infill);
  options.print_remarks = std::move(found.remarks);
  if (force_ && !options.infill_is_known)
    throw UsageError("--force without --infill has no effect",
                     "a print is refused only if its infill is known");
  options.heavier = force_ ? HeavierPrint::allow : HeavierPrint::refuse;
  if (described != nullptr) {
    for (const Row& row : rows_) {
      if (is_known(row.setting) || !is_of_rules(row.setting))
        options.print_origins.push_back(origin_of(row.setting, found, options));
    }
  }
  if (is_known(PrintSetting::line_width))
    options.line_width_origin = origin_of(PrintSetting::line_width, found, options).origin;
  return options;
}

void PrintOptions::require_lines_that_fit(const HollowOptions& options) const {
  if (given() == nullptr) return;
  const PrintSettings& settings = options.print;
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
  const PackingLimits limits = options.packing.limits();
  require(limits.wall, "--wall");
  require(limits.gap, "--gap");
}

}  // namespace aerate::cli
