#include "printing/slicers/print_settings_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/error.h"
#include "files/input_file.h"
#include "files/text_scan.h"
#include "files/three_mf_package.h"
#include "printing/slicers/gcode.h"
#include "printing/slicers/ini_settings.h"
#include "printing/slicers/setting_names.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

using Values = std::map<std::string, std::string, std::less<>>;

constexpr const char* kExport =
    "give the settings in use (PrusaSlicer: File, Export, Export Config), G-code, or a project saved as 3MF";

// Slicers make lines so wide that are not said to be of some width.
constexpr double kAutomaticWidth = 1.125;  // nozzles

// No line or layer is thicker, mm.
constexpr double kWidest = 10;

// What a width in percent is a share of.
enum class PercentOf { layer_height, nozzle };

// How a family of slicers calls what is looked for.
struct Dialect {
  const char* infill;
  const char* pattern;
  const char* perimeters;
  const char* top_layers;
  const char* bottom_layers;
  const char* spiral;
  // Of the walls, of all lines, of the outermost wall.
  const char* wall_width;
  const char* any_width;
  const char* outer_width;
  PercentOf percent_of;
};
constexpr Dialect kPrusa{"fill_density",
                         "fill_pattern",
                         "perimeters",
                         "top_solid_layers",
                         "bottom_solid_layers",
                         "spiral_vase",
                         "perimeter_extrusion_width",
                         "extrusion_width",
                         "external_perimeter_extrusion_width",
                         PercentOf::layer_height};
constexpr Dialect kOrca{"sparse_infill_density",
                        "sparse_infill_pattern",
                        "wall_loops",
                        "top_shell_layers",
                        "bottom_shell_layers",
                        "spiral_mode",
                        "inner_wall_line_width",
                        "line_width",
                        "outer_wall_line_width",
                        PercentOf::nozzle};
// PrusaSlicer's alone.
constexpr const char* kVerticalShells = "ensure_vertical_shell_thickness";
constexpr const char* kWalls = "perimeter_generator";
// Both call these so.
constexpr const char* kLayerHeight = "layer_height";
constexpr const char* kNozzle = "nozzle_diameter";

std::vector<std::string_view> keys_of(const Dialect& dialect) {
  return {dialect.infill,     dialect.pattern,       dialect.perimeters,
          dialect.top_layers, dialect.bottom_layers, dialect.wall_width,
          dialect.any_width,  dialect.outer_width,   kLayerHeight};
}

std::size_t count_keys(const Values& values, const Dialect& dialect) {
  const auto keys = keys_of(dialect);
  return static_cast<std::size_t>(
      std::ranges::count_if(keys, [&](std::string_view key) { return values.contains(key); }));
}

// A key that is one of the slicer's but for a slip, where that is missing.
void require_no_misspelt_key(const Values& values, const Dialect& dialect, const std::string& file) {
  std::vector<std::string_view> missing = keys_of(dialect);
  std::erase_if(missing, [&](std::string_view key) { return values.contains(key); });
  for (const auto& [key, value] : values) {
    const std::string_view meant = nearest_name(key, missing);
    if (meant.empty()) continue;
    throw InputError(fmt::format("{}: {} is no setting of a slicer", file, on_one_line(key)),
                     fmt::format("is {} meant?", meant));
  }
}

// Text, or the first of several of a list, as for each extruder.
std::string text_of(const nlohmann::json& value) {
  const nlohmann::json& first = value.is_array() && !value.empty() ? value.front() : value;
  if (first.is_string()) return first.get<std::string>();
  return first.is_number() || first.is_boolean() ? first.dump() : "";
}

Values values_of_json(std::string_view text, const std::string& file, std::vector<std::string>& remarks) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object())
    throw InputError(file + ": is no JSON object, as the settings of OrcaSlicer and Bambu Studio are",
                     kExport);
  Values values;
  for (const auto& [key, value] : json.items()) values[key] = text_of(value);
  if (const auto parent = values.find("inherits"); parent != values.end() && !parent->second.empty())
    remarks.push_back(
        fmt::format("{}: a preset that says how it differs from \"{}\" alone: what it leaves out is not that "
                    "preset's here; "
                    "G-code or a project holds everything",
                    file, on_one_line(parent->second)));
  return values;
}

Values values_of_lines(std::string_view text) {
  Values values;
  for_each_line(text, [&](std::string_view line) {
    if (const auto setting = setting_in_line(line))
      values[std::string(setting->key)] = std::string(setting->value);
    return true;
  });
  return values;
}

bool has_nothing(std::string_view text) {
  return without_blanks(text).empty();
}

// One file's settings, which become those of a print one by one.
class Reader {
 public:
  Reader(const Values& values, const Dialect& dialect, PercentOf percent_of, const std::string& file,
         const KnownPrintSettings& known)
      : values_(values), dialect_(dialect), percent_of_(percent_of), file_(file), known_(known.which) {
    found_.settings = known.settings;
  }

  // `version`: of PrusaSlicer, if that made the file. Settings that rules of older ones do not ask for are not looked at.
  FoundPrintSettings read(std::vector<std::string> remarks, const std::optional<SlicerVersion>& version) {
    found_.remarks = std::move(remarks);
    require_no_spiral();
    PrintSettings& print = found_.settings;
    if (const auto text = wanted(PrintSetting::infill, dialect_.infill)) print.infill = share(*text);
    if (const auto text = wanted(PrintSetting::pattern, dialect_.pattern)) print.pattern = pattern(*text);
    constexpr int kMostWalls = 100, kMostLayers = 1000;
    if (const auto text = wanted(PrintSetting::perimeters, dialect_.perimeters))
      print.perimeters = whole(dialect_.perimeters, *text, kMostWalls, "--perimeters");
    if (const auto text = wanted(PrintSetting::top_layers, dialect_.top_layers))
      print.top_layers = whole(dialect_.top_layers, *text, kMostLayers, "--top-layers");
    if (const auto text = wanted(PrintSetting::bottom_layers, dialect_.bottom_layers))
      print.bottom_layers = whole(dialect_.bottom_layers, *text, kMostLayers, "--bottom-layers");
    if (const auto text = wanted(PrintSetting::layer_height, kLayerHeight))
      print.layer_height = length(kLayerHeight, *text, "--layer-height");
    read_line_width();
    read_rules(version);
    return std::move(found_);
  }

 private:
  std::optional<std::string> value_of(const char* key) const {
    const auto at = values_.find(key);
    if (at == values_.end()) return std::nullopt;
    const std::string_view all = without_blanks(at->second);
    return std::string(without_blanks(all.substr(0, all.find(','))));  // the first extruder's
  }

  std::optional<std::string> wanted(PrintSetting setting, const char* key) {
    if (known_.contains(setting)) return std::nullopt;
    auto text = value_of(key);
    if (text) found_.keys[setting] = key;
    return text;
  }

  void read_rules(const std::optional<SlicerVersion>& version) {
    PrintSettings& print = found_.settings;
    const bool is_new = version && rules_of(*version) != SolidRules::prusa_2_5;
    if (is_new && !known_.contains(PrintSetting::slicer_version)) {
      print.rules = rules_of(*version);
      found_.keys[PrintSetting::slicer_version] = "PrusaSlicer " + to_text(*version);
    }
    if (print.rules == SolidRules::prusa_2_5) return;
    if (const auto text = wanted(PrintSetting::vertical_shells, kVerticalShells)) {
      const auto value = parse_vertical_shells(*text);
      if (!value) refuse(kVerticalShells, *text, "not known here", "--vertical-shells");
      print.vertical_shells = *value;
    }
    if (const auto text = wanted(PrintSetting::walls, kWalls)) {
      const auto value = parse_walls(*text);
      if (!value) refuse(kWalls, *text, "not known here", "--wall-generator");
      print.walls = *value;
    }
  }

  [[noreturn]] void refuse(const char* key, std::string_view text, const char* what,
                           const char* option) const {
    throw InputError(fmt::format("{}: {} = {} is {}", file_, key, on_one_line(text), what),
                     fmt::format("correct it, or say it by {}", option));
  }

  std::optional<double> number(std::string_view text) const {
    const auto value = take_number(text);
    return value && text.empty() ? value : std::nullopt;
  }

  void require_no_spiral() const {
    const auto value = value_of(dialect_.spiral);
    if (value && (*value == "1" || *value == "true"))
      throw InputError(fmt::format("{}: is of a print in vase mode ({} = {}), which has one wall and nothing "
                                   "inside that could be saved",
                                   file_, dialect_.spiral, *value),
                       "switch that off, or print the model as it is");
  }

  double share(std::string_view text) const {
    const std::string_view digits = text.ends_with('%') ? text.substr(0, text.size() - 1) : text;
    const auto percent = number(digits);
    if (!percent || *percent < 0 || *percent > 100)
      refuse(dialect_.infill, text, "no share from 0 % to 100 %", "--infill");
    return *percent / 100;
  }

  int whole(const char* key, std::string_view text, int most, const char* option) const {
    const auto value = number(text);
    if (!value || *value < 0 || *value > most || *value != std::floor(*value))
      refuse(key, text, "no count", option);
    return static_cast<int>(*value);
  }

  double length(const char* key, std::string_view text, const char* option) const {
    constexpr double kLeast = 0.01, kMost = kWidest;  // mm
    const auto value = number(text);
    if (!value || *value < kLeast || *value > kMost) refuse(key, text, "no length in mm", option);
    return *value;
  }

  InfillPattern pattern(std::string_view text) {
    constexpr std::array<std::string_view, 24> kStraight{"rectilinear",
                                                         "alignedrectilinear",
                                                         "monotonic",
                                                         "monotoniclines",
                                                         "grid",
                                                         "triangles",
                                                         "stars",
                                                         "tri-hexagon",
                                                         "trihexagon",
                                                         "cubic",
                                                         "quartercubic",
                                                         "line",
                                                         "concentric",
                                                         "honeycomb",
                                                         "3dhoneycomb",
                                                         "hilbertcurve",
                                                         "archimedeanchords",
                                                         "octagramspiral",
                                                         "zig-zag",
                                                         "zigzag",
                                                         "crosszag",
                                                         "crosshatch",
                                                         "2dlattice",
                                                         "lateral-lattice"};
    constexpr std::array<std::string_view, 2> kSparser{"adaptivecubic", "supportcubic"};
    constexpr std::array<std::string_view, 3> kWaves{"gyroid", "tpmsd", "tpmsfk"};
    if (text == "lightning")
      throw InputError(
          fmt::format("{}: {} = lightning takes far less than its density, which is not predicted", file_,
                      dialect_.pattern),
          "voids have little to save there: print the model as it is; --infill-pattern lines predicts as if "
          "its density held");
    if (std::ranges::find(kWaves, text) != kWaves.end()) return InfillPattern::gyroid;
    if (std::ranges::find(kSparser, text) != kSparser.end()) {
      found_.remarks.push_back(fmt::format(
          "{}: {} = {} is sparser than its density well inside: voids save less than is predicted", file_,
          dialect_.pattern, text));
      return InfillPattern::lines;
    }
    if (std::ranges::find(kStraight, text) != kStraight.end()) return InfillPattern::lines;
    refuse(dialect_.pattern, text, "a pattern that is not known here", "--infill-pattern gyroid or lines");
  }

  double nozzle(const char* key, std::string_view text) const {
    const auto nozzle = value_of(kNozzle);
    if (!nozzle)
      throw InputError(fmt::format("{}: {} = {} depends on {}, which is not in it", file_, key,
                                   on_one_line(text), kNozzle),
                       "say it by --line-width");
    return length(kNozzle, *nozzle, "--line-width");
  }

  // A width of 0 leaves it to the next key.
  std::optional<double> width(const char* key, std::string_view text) const {
    const bool is_share = text.ends_with('%');
    const auto value = number(is_share ? text.substr(0, text.size() - 1) : text);
    if (!value || *value < 0) refuse(key, text, "no width", "--line-width");
    if (*value == 0) return std::nullopt;
    if (!is_share) return length(key, text, "--line-width");
    const double whole = percent_of_ == PercentOf::nozzle ? nozzle(key, text) : layer_height(key, text);
    const double width = *value / 100 * whole;
    if (width > kWidest) refuse(key, text, "too wide", "--line-width");
    return width;
  }

  double layer_height(const char* key, std::string_view text) const {
    if (known_.contains(PrintSetting::layer_height)) return found_.settings.layer_height;
    if (const auto height = value_of(kLayerHeight)) return length(kLayerHeight, *height, "--line-width");
    throw InputError(fmt::format("{}: {} = {} depends on {}, which is not in it", file_, key,
                                 on_one_line(text), kLayerHeight),
                     "say it by --line-width");
  }

  void read_line_width() {
    if (known_.contains(PrintSetting::line_width)) return;
    const char* automatic = nullptr;
    for (const char* key : {dialect_.wall_width, dialect_.any_width, dialect_.outer_width}) {
      // Where all lines are automatic, so are those of walls.
      if (automatic != nullptr && key == dialect_.outer_width) break;
      const auto text = value_of(key);
      if (!text) continue;
      automatic = key;
      if (const auto said = width(key, *text)) {
        found_.settings.line_width = *said;
        found_.keys[PrintSetting::line_width] = key;
        return;
      }
    }
    if (automatic == nullptr) return;
    found_.settings.line_width = kAutomaticWidth * nozzle(automatic, "0");
    found_.keys[PrintSetting::line_width] = fmt::format("{} = 0: {:g} nozzles", automatic, kAutomaticWidth);
  }

  const Values& values_;
  const Dialect& dialect_;
  PercentOf percent_of_;
  const std::string& file_;
  const std::set<PrintSetting>& known_;
  FoundPrintSettings found_;
};

// What a text is that has no such settings.
[[noreturn]] void refuse_unknown(std::string_view text, const Values& values, const std::string& file) {
  if (const auto type = values.find("type");
      type != values.end() && (type->second == "machine" || type->second == "filament"))
    throw InputError(
        fmt::format("{}: is a preset of a {}, which does not describe a print", file, type->second),
        "give the preset of the process");
  const bool is_gcode = origin_of(text).slicer != nullptr || extrudes(text);
  throw InputError(is_gcode
                       ? fmt::format("{}: is G-code without the slicer's settings at its end", file)
                       : fmt::format("{}: has none of the settings of a print ({}, {}, ..; {}, {}, ..)", file,
                                     kPrusa.infill, kPrusa.perimeters, kOrca.infill, kOrca.perimeters),
                   kExport);
}

// The settings of a project, in the text that they are packed as.
std::string settings_of_project(const std::filesystem::path& path) {
  const InputFile file = read_file(path);
  const ThreeMfPackage package(file);
  for (const char* entry : {"Metadata/Slic3r_PE.config", "Metadata/project_settings.config"}) {
    if (!package.has(entry)) continue;
    std::string text;
    package.read(entry, [&](std::string_view block) { text += block; });
    if (!has_nothing(text)) return text;
  }
  throw InputError(path.string() + ": is a 3MF without a slicer's settings",
                   "save it as a project in the slicer");
}

}  // namespace

SolidRules rules_of(const SlicerVersion& version) {
  return version < SlicerVersion{2, 6, 0} ? SolidRules::prusa_2_5 : SolidRules::prusa_2_6;
}

std::optional<VerticalShells> parse_vertical_shells(std::string_view text) {
  if (text == "enabled" || text == "1") return VerticalShells::enabled;
  if (text == "partial" || text == "0") return VerticalShells::partial;
  if (text == "disabled") return VerticalShells::disabled;
  return std::nullopt;
}

std::optional<WallGenerator> parse_walls(std::string_view text) {
  if (text == "arachne") return WallGenerator::arachne;
  if (text == "classic") return WallGenerator::classic;
  return std::nullopt;
}

FoundPrintSettings print_settings_in(std::string_view text, const std::string& file,
                                     const KnownPrintSettings& known) {
  text.remove_prefix(start_of_text(text));
  if (has_nothing(text)) throw InputError(file + ": is empty", kExport);
  if (is_binary_gcode(text))
    throw InputError(file + ": is binary G-code, whose settings are packed",
                     "switch binary G-code off in the slicer's printer settings, or export the settings");
  std::vector<std::string> remarks;
  const bool is_json = without_blanks(text).starts_with('{');
  if (!is_json) require_no_bundle(text, file);
  const Values values = is_json ? values_of_json(text, file, remarks) : values_of_lines(plain_settings(text));
  const std::size_t prusa = count_keys(values, kPrusa), orca = count_keys(values, kOrca);
  const bool is_orca = prusa == orca ? is_json : orca > prusa;
  const Dialect& dialect = is_orca ? kOrca : kPrusa;
  require_no_misspelt_key(values, dialect, file);
  if (std::max(prusa, orca) == 0) refuse_unknown(text, values, file);
  constexpr std::size_t kHead = 400;  // bytes: where slicers name themselves
  const std::string_view head = text.substr(0, kHead);
  const bool is_super = head.find("SuperSlicer") != std::string_view::npos;
  const bool is_slic3r = head.find("generated by Slic3r 1") != std::string_view::npos;
  Reader reader(values, dialect, is_super ? PercentOf::nozzle : dialect.percent_of, file, known);
  FoundPrintSettings found = reader.read(std::move(remarks), version_of("PrusaSlicer", head));
  const auto width = found.keys.find(PrintSetting::line_width);
  if (is_slic3r && width != found.keys.end() && width->second.ends_with("nozzles"))
    found.remarks.push_back(
        fmt::format("{}: Slic3r chooses the width of its lines by itself, in a way that is not known here: "
                    "{:g} mm is taken; "
                    "--line-width says what it is",
                    file, found.settings.line_width));
  return found;
}

FoundPrintSettings read_print_settings(const std::filesystem::path& file, const KnownPrintSettings& known) {
  const std::string text = read_text(file);
  const bool is_package = text.starts_with("PK\x03\x04");
  return print_settings_in(is_package ? settings_of_project(file) : text, file.string(), known);
}

}  // namespace aerate
