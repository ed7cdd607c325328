#include "printing/slicers/gcode.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <utility>

namespace aerate {
namespace {

// Calls f(line) for each line, without its line end; f returns false to stop.
template <typename F>
void for_each_line(std::string_view text, const F& f) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!f(line)) return;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

// The number at the front of `text`, which is taken off it.
std::optional<double> take_number(std::string_view& text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

// "1.5, 2.25" of several extruders.
std::optional<double> take_sum(std::string_view text) {
  std::optional<double> sum = take_number(text);
  while (sum && trimmed(text).starts_with(',')) {
    text = trimmed(text).substr(1);
    const std::optional<double> next = take_number(text);
    if (!next) return std::nullopt;
    sum = *sum + *next;
  }
  return sum;
}

// "1d 2h 3m 4s"
std::optional<double> take_duration(std::string_view text) {
  double seconds = 0;
  bool found = false;
  while (const std::optional<double> number = take_number(text)) {
    constexpr std::array<std::pair<char, double>, 4> kUnits{{{'d', 86400}, {'h', 3600}, {'m', 60}, {'s', 1}}};
    const auto unit = std::find_if(kUnits.begin(), kUnits.end(),
                                   [&](const auto& each) { return text.starts_with(each.first); });
    if (unit == kUnits.end()) return std::nullopt;
    seconds += *number * unit->second;
    found = true;
    text.remove_prefix(1);
  }
  return found ? std::optional(seconds) : std::nullopt;
}

// What stands after `label` and "=" or ":" in a comment line, if it begins with that label.
std::optional<std::string_view> value_after(std::string_view line, std::string_view label) {
  if (!line.starts_with(';')) return std::nullopt;
  line = trimmed(line.substr(1));
  if (!line.starts_with(label)) return std::nullopt;
  line = trimmed(line.substr(label.size()));
  if (!line.starts_with('=') && !line.starts_with(':')) return std::nullopt;
  return trimmed(line.substr(1));
}

void read_figure(std::string_view line, GcodeFigures& figures) {
  if (const auto text = value_after(line, "filament used [mm]")) figures.filament_mm = take_sum(*text);
  if (const auto text = value_after(line, "filament used [cm3]")) figures.filament_cm3 = take_sum(*text);
  if (const auto text = value_after(line, "filament used [g]")) figures.filament_g = take_sum(*text);
  if (const auto text = value_after(line, "filament cost")) figures.cost = take_sum(*text);
  if (const auto text = value_after(line, "estimated printing time (normal mode)"))
    figures.seconds = take_duration(*text);
  if (const auto text = value_after(line, "filament used")) {  // Slic3r: "192.5mm (1.4cm3)"
    std::string_view rest = *text;
    figures.filament_mm = take_number(rest);
    if (const std::size_t open = rest.find('('); open != std::string_view::npos) {
      rest.remove_prefix(open + 1);
      figures.filament_cm3 = take_number(rest);
    }
  }
  if (const auto text = value_after(line, "Filament used")) {  // Cura: "0.228916m", of each extruder
    constexpr double kMillimetresPerMetre = 1000;
    double metres = 0;
    std::string_view rest = *text;
    while (const std::optional<double> length = take_number(rest)) {
      metres += *length;
      if (rest.starts_with('m')) rest.remove_prefix(1);
      if (rest.starts_with(',')) rest.remove_prefix(1);
    }
    figures.filament_mm = metres * kMillimetresPerMetre;
  }
  if (line.starts_with(";TIME:")) {
    std::string_view text = line.substr(std::string_view(";TIME:").size());
    figures.seconds = take_number(text);
  }
}

bool marks_layer(std::string_view line) {
  return line == ";LAYER_CHANGE" || line == "; CHANGE_LAYER" || line.starts_with(";LAYER:");
}

std::size_t count_heights(std::string_view gcode) {
  std::vector<double> heights;
  for (const ExtrusionMove& move : extrusion_moves(gcode)) {
    if (heights.empty() || heights.back() != move.z) heights.push_back(move.z);
  }
  std::sort(heights.begin(), heights.end());
  return static_cast<std::size_t>(std::unique(heights.begin(), heights.end()) - heights.begin());
}

// Follows the machine's position.
class Interpreter {
 public:
  // Returns true if the line was a move that extruded.
  bool run(std::string_view line) {
    line = trimmed(line.substr(0, line.find(';')));
    if (line.size() < 2) return false;
    const char letter = line.front();
    line.remove_prefix(1);
    const std::optional<double> number = take_number(line);
    if (!number) return false;
    const int code = static_cast<int>(*number);
    if (letter == 'M' && code == 82) relative_filament_ = false;
    if (letter == 'M' && code == 83) relative_filament_ = true;
    if (letter != 'G') return false;
    if (code == 90) relative_ = relative_filament_ = false;
    if (code == 91) relative_ = relative_filament_ = true;
    if (code == 92) set_position(line);
    return code >= 0 && code <= 3 && move(line);
  }

  ExtrusionMove state() const { return {axes_[0], axes_[1], axes_[2], fed_}; }

 private:
  static int axis_of(char letter) {
    constexpr std::string_view kAxes = "XYZE";
    const std::size_t axis = kAxes.find(letter);
    return axis == std::string_view::npos ? -1 : static_cast<int>(axis);
  }

  template <typename F>
  static void for_each_word(std::string_view line, const F& f) {
    for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
      const char letter = line.front();
      line.remove_prefix(1);
      const std::optional<double> value = take_number(line);
      if (!value) continue;
      if (const int axis = axis_of(letter); axis >= 0) f(static_cast<std::size_t>(axis), *value);
    }
  }

  void set_position(std::string_view line) {
    for_each_word(line, [&](std::size_t axis, double value) { axes_[axis] = value; });
  }

  bool move(std::string_view line) {
    const std::array<double, 4> before = axes_;
    for_each_word(line, [&](std::size_t axis, double value) {
      const bool relative = axis == kFilament ? relative_filament_ : relative_;
      axes_[axis] = relative ? axes_[axis] + value : value;
    });
    fed_ = axes_[kFilament] - before[kFilament];
    const bool travels = axes_[0] != before[0] || axes_[1] != before[1] || axes_[2] != before[2];
    return travels && fed_ > 0;
  }

  static constexpr std::size_t kFilament = 3;
  std::array<double, 4> axes_{};
  double fed_ = 0;
  bool relative_ = false;
  bool relative_filament_ = false;
};

// Offset and length of the line "; key = ..." with its line end.
std::optional<std::pair<std::size_t, std::size_t>> find_setting(std::string_view gcode,
                                                                std::string_view key) {
  const std::string start = "; " + std::string(key) + " =";
  const std::size_t at = gcode.rfind("\n" + start);
  if (at == std::string_view::npos) return std::nullopt;
  const std::size_t end = std::min(gcode.find('\n', at + 1), gcode.size() - 1);
  return std::pair{at + 1, end - at};
}

}  // namespace

bool is_binary_gcode(std::string_view gcode) {
  return gcode.starts_with("GCDE");
}

GcodeOrigin origin_of(std::string_view gcode) {
  constexpr std::size_t kLinesLookedAt = 40;
  constexpr std::array<std::pair<std::string_view, GcodeGenerator>, 6> kNames{{
      {"generated by PrusaSlicer", GcodeGenerator::prusa_slicer},
      {"generated by SuperSlicer", GcodeGenerator::super_slicer},
      {"generated by OrcaSlicer", GcodeGenerator::orca_slicer},
      {"generated by Slic3r", GcodeGenerator::slic3r},
      {"Generated with Cura", GcodeGenerator::cura},
      {"BambuStudio", GcodeGenerator::bambu_studio},
  }};
  GcodeOrigin origin;
  std::size_t seen = 0;
  for_each_line(gcode, [&](std::string_view line) {
    if (!line.starts_with(';')) return ++seen < kLinesLookedAt;
    for (const auto& [name, generator] : kNames) {
      if (line.find(name) == std::string_view::npos) continue;
      origin.generator = generator;
      std::string_view text = trimmed(line.substr(1));
      for (const std::string_view lead : {"generated by ", "Generated with "}) {
        if (text.starts_with(lead)) text.remove_prefix(lead.size());
      }
      origin.name = text.substr(0, text.find(" on "));
      return false;
    }
    return ++seen < kLinesLookedAt;
  });
  return origin;
}

GcodeFigures figures_of(std::string_view gcode) {
  GcodeFigures figures;
  for_each_line(gcode, [&](std::string_view line) {
    if (line.starts_with(';')) {
      read_figure(line, figures);
      if (marks_layer(line)) ++figures.layers;
    }
    return true;
  });
  if (figures.layers == 0) figures.layers = count_heights(gcode);
  return figures;
}

std::optional<std::string> setting_in(std::string_view gcode, std::string_view key) {
  const auto found = find_setting(gcode, key);
  if (!found) return std::nullopt;
  std::string_view line = gcode.substr(found->first, found->second);
  while (line.ends_with('\n') || line.ends_with('\r')) line.remove_suffix(1);
  return std::string(trimmed(line.substr(line.find('=') + 1)));
}

std::string with_setting_of(std::string gcode, std::string_view original, std::string_view key) {
  const auto here = find_setting(gcode, key), there = find_setting(original, key);
  if (here && there) gcode.replace(here->first, here->second, original.substr(there->first, there->second));
  return gcode;
}

std::vector<ExtrusionMove> extrusion_moves(std::string_view gcode) {
  std::vector<ExtrusionMove> moves;
  Interpreter machine;
  for_each_line(gcode, [&](std::string_view line) {
    if (machine.run(line)) moves.push_back(machine.state());
    return true;
  });
  return moves;
}

bool extrudes(std::string_view gcode) {
  bool found = false;
  Interpreter machine;
  for_each_line(gcode, [&](std::string_view line) {
    found = machine.run(line);
    return !found;
  });
  return found;
}

std::optional<std::string> difference_of(const std::vector<ExtrusionMove>& a,
                                         const std::vector<ExtrusionMove>& b) {
  constexpr double kRounding = 0.01;  // mm; slicers write three decimals
  const std::size_t common = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < common; ++i) {
    const double distance = std::max({std::abs(a[i].x - b[i].x), std::abs(a[i].y - b[i].y),
                                      std::abs(a[i].z - b[i].z), std::abs(a[i].filament - b[i].filament)});
    if (distance > kRounding) {
      char text[128];
      std::snprintf(text, sizeof text,
                    "extrusion %zu of %zu ends at (%.2f, %.2f, %.2f) mm and not at (%.2f, %.2f, %.2f) mm",
                    i + 1, a.size(), a[i].x, a[i].y, a[i].z, b[i].x, b[i].y, b[i].z);
      return text;
    }
  }
  if (a.size() != b.size())
    return std::to_string(a.size()) + " extrusions and not " + std::to_string(b.size());
  return std::nullopt;
}

std::string with_comments(std::string_view gcode, std::string_view comments) {
  std::size_t at = 0;
  if (gcode.starts_with(';')) at = std::min(gcode.find('\n'), gcode.size() - 1) + 1;
  if (gcode.starts_with("; HEADER_BLOCK_START")) {
    constexpr std::string_view kEnd = "; HEADER_BLOCK_END";
    const std::size_t end = gcode.find(kEnd);
    if (end != std::string_view::npos) at = std::min(gcode.find('\n', end), gcode.size() - 1) + 1;
  }
  std::string result(gcode.substr(0, at));
  if (!result.empty() && !result.ends_with('\n')) result += '\n';
  result += comments;
  result += gcode.substr(at);
  return result;
}

}  // namespace aerate
