#include "printing/slicers/gcode.h"

#include <algorithm>
#include <utility>

#include "printing/slicers/gcode_machine.h"
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
    const auto text = value_after(comment, line.label);
    if (!text) continue;
    const std::optional<double> value = line.value_of(*text);
    if (!value) continue;
    std::optional<double>& figure = figures.*line.figure;
    figure = *value + (line.adds_up ? figure.value_or(0) : 0);
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
  std::string pictures, picture;
  bool inside = false;
  for_each_line(gcode, [&](std::string_view line) {
    // They stand before the first command; one that does not end is none.
    if (!line.empty() && !line.starts_with(';')) return false;
    const bool names_it = line.starts_with("; thumbnail");
    if (names_it && line.find(" begin ") != std::string_view::npos) inside = true;
    if (inside) picture.append(line).append("\n");
    if (inside && names_it && line.ends_with(" end")) {
      inside = false;
      pictures += std::exchange(picture, {});
    }
    return true;
  });
  return pictures;
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
  // A line of a few letters can be a circle of kilometres: chords take no more memory than so much text would.
  constexpr std::size_t kFewest = 100'000, kBytesPerMove = 4;
  constexpr std::size_t kMostChords = 10'000;
  const std::size_t most = std::max(kFewest, gcode.size() / kBytesPerMove);
  std::vector<ExtrusionMove> moves;
  GcodeMachine machine;
  for_each_line(gcode, [&](std::string_view line) {
    if (machine.run(line))
      machine.append_moves(moves, std::min(kMostChords, most - std::min(most, moves.size())));
    return true;
  });
  return moves;
}

bool extrudes(std::string_view gcode) {
  bool found = false;
  GcodeMachine machine;
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
