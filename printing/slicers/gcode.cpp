#include "printing/slicers/gcode.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
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
    if (code < 0 || code > 3) return false;
    turn_ = code == 2 ? -1 : code == 3 ? 1 : 0;
    return move(line);
  }

  // The move that `run` reported, appended: one, or the chords of an arc.
  void append_moves(std::vector<ExtrusionMove>& moves) const {
    const double from_x = before_[0], from_y = before_[1];
    if (turn_ == 0) {
      moves.push_back({from_x, from_y, axes_[0], axes_[1], axes_[2], fed_});
      return;
    }
    constexpr double kLongestChord = 1;  // mm
    const double centre_x = from_x + centre_offset_[0], centre_y = from_y + centre_offset_[1];
    const double radius = std::hypot(centre_offset_[0], centre_offset_[1]);
    const double begin = std::atan2(from_y - centre_y, from_x - centre_x);
    double angle = std::atan2(axes_[1] - centre_y, axes_[0] - centre_x) - begin;
    if (turn_ * angle <= 0) angle += turn_ * kFullTurn;
    const auto chords =
        static_cast<int>(std::clamp(std::ceil(std::abs(angle) * radius / kLongestChord), 1.0, 1e4));
    double x = from_x, y = from_y;
    for (int i = 1; i <= chords; ++i) {
      const double to = begin + angle * i / chords;
      const double next_x = i == chords ? axes_[0] : centre_x + radius * std::cos(to);
      const double next_y = i == chords ? axes_[1] : centre_y + radius * std::sin(to);
      moves.push_back({x, y, next_x, next_y, axes_[2], fed_ / chords});
      x = next_x;
      y = next_y;
    }
  }

 private:
  static int axis_of(char letter) {
    constexpr std::string_view kAxes = "XYZEIJ";
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
    for_each_word(line, [&](std::size_t axis, double value) {
      if (axis < axes_.size()) axes_[axis] = value;
    });
  }

  bool move(std::string_view line) {
    before_ = axes_;
    centre_offset_ = {};
    for_each_word(line, [&](std::size_t axis, double value) {
      if (axis > kFilament) {
        centre_offset_[axis - kFilament - 1] = value;
        return;
      }
      const bool relative = axis == kFilament ? relative_filament_ : relative_;
      axes_[axis] = relative ? axes_[axis] + value : value;
    });
    if (centre_offset_ == std::array<double, 2>{}) turn_ = 0;  // given by its radius: taken as straight
    fed_ = axes_[kFilament] - before_[kFilament];
    const bool travels =
        turn_ != 0 || axes_[0] != before_[0] || axes_[1] != before_[1] || axes_[2] != before_[2];
    return travels && fed_ > 0;
  }

  static constexpr std::size_t kFilament = 3;
  static constexpr double kFullTurn = 2 * std::numbers::pi;
  std::array<double, 4> axes_{}, before_{};
  std::array<double, 2> centre_offset_{};  // of an arc, from where it begins
  int turn_ = 0;                           // 1 counterclockwise, -1 clockwise, 0 straight
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

// The lines from "; thumbnail begin ..." to "; thumbnail end"; other formats are "thumbnail_QOI" and the
// like.
std::string thumbnails_in(std::string_view gcode) {
  std::string pictures;
  bool inside = false;
  for_each_line(gcode, [&](std::string_view line) {
    const bool names_it = line.starts_with("; thumbnail");
    if (names_it && line.find(" begin ") != std::string_view::npos) inside = true;
    if (inside) pictures.append(line).append("\n");
    if (names_it && line.ends_with(" end")) inside = false;
    return inside || line.empty() || line.starts_with(';');  // they stand before the first command
  });
  return pictures;
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

std::string with_thumbnails_of(std::string gcode, std::string_view original) {
  std::string pictures = thumbnails_in(original);
  if (pictures.empty() || !thumbnails_in(gcode).empty()) return gcode;
  return with_comments(gcode, "\n;\n" + pictures + ";\n");
}

std::vector<ExtrusionMove> extrusion_moves(std::string_view gcode) {
  std::vector<ExtrusionMove> moves;
  Interpreter machine;
  for_each_line(gcode, [&](std::string_view line) {
    if (machine.run(line)) machine.append_moves(moves);
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
