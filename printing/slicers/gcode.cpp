#include "printing/slicers/gcode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "printing/slicers/slicers.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

// What stands after `label` and "=" or ":" in a comment, if it begins with that label.
std::optional<std::string_view> value_after(std::string_view comment, std::string_view label) {
  std::string_view line = trimmed(comment.substr(1));
  if (!line.starts_with(label)) return std::nullopt;
  line = trimmed(line.substr(label.size()));
  if (!line.starts_with('=') && !line.starts_with(':')) return std::nullopt;
  return trimmed(line.substr(1));
}

void read_figures(std::string_view comment, const SlicerProfile& slicer, GcodeFigures& figures) {
  for (const FigureLine& line : slicer.figures) {
    if (const auto text = value_after(comment, line.label)) figures.*line.figure = line.value_of(*text);
  }
  if (slicer.begins_layer(comment)) ++figures.layers;
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

std::string_view without_blanks(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  return text.substr(0, text.find_last_not_of(" \t\r\n") + 1);
}

GcodeOrigin origin_in(std::string_view comment) {
  for (const SlicerProfile& slicer : slicers()) {
    for (const std::string_view mark : slicer.marks) {
      const std::size_t at = comment.find(mark);
      if (at == std::string_view::npos) continue;
      const std::string_view name = comment.substr(at + mark.rfind(' ') + 1);
      return {&slicer, std::string(trimmed(name.substr(0, name.find(" on "))))};
    }
  }
  return {};
}

}  // namespace

bool is_binary_gcode(std::string_view gcode) {
  return gcode.starts_with("GCDE");
}

GcodeOrigin origin_of(std::string_view gcode) {
  constexpr std::size_t kLinesLookedAt = 40;
  GcodeOrigin origin;
  std::size_t seen = 0;
  for_each_line(gcode, [&](std::string_view line) {
    if (line.starts_with(';')) origin = origin_in(line);
    return origin.slicer == nullptr && ++seen < kLinesLookedAt;
  });
  return origin;
}

GcodeFigures figures_of(std::string_view gcode, const SlicerProfile& slicer, GcodeFigures known) {
  GcodeFigures figures = known;
  for_each_line(gcode, [&](std::string_view line) {
    if (line.starts_with(';')) read_figures(line, slicer, figures);
    return true;
  });
  if (figures.layers == 0) figures.layers = count_heights(gcode);
  return figures;
}

std::optional<SettingLine> setting_in_line(std::string_view line) {
  if (line.starts_with("; ")) line.remove_prefix(2);
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  return SettingLine{without_blanks(line.substr(0, equals)), without_blanks(line.substr(equals + 1))};
}

bool names_post_processing(std::string_view line) {
  const auto setting = setting_in_line(line);
  return setting && setting->key == kPostProcess &&
         setting->value.find_first_not_of(" \t\"") != std::string_view::npos;
}

std::optional<std::string> setting_in(std::string_view gcode, std::string_view key) {
  const auto found = find_setting(gcode, key);
  if (!found) return std::nullopt;
  return std::string(setting_in_line(gcode.substr(found->first, found->second))->value);
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
