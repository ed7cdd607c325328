#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aerate {

// What a slicer says about its own G-code; absent where it says nothing. Several extruders are added up.
struct GcodeFigures {
  std::optional<double> filament_mm;
  std::optional<double> filament_cm3;
  std::optional<double> filament_g;
  std::optional<double> cost;
  std::optional<double> seconds;
  std::size_t layers = 0;  // those with extrusion, where the slicer does not mark layers
};

struct NamedFigure {
  const char* name;
  std::optional<double> GcodeFigures::*figure;
  int decimals;  // that are worth showing
};
inline constexpr std::array<NamedFigure, 5> kNamedFigures{{
    {"filament_mm", &GcodeFigures::filament_mm, 2},
    {"filament_cm3", &GcodeFigures::filament_cm3, 2},
    {"filament_g", &GcodeFigures::filament_g, 2},
    {"cost", &GcodeFigures::cost, 2},
    {"seconds", &GcodeFigures::seconds, 0},
}};

struct SlicerProfile;

// Whose G-code this is, by the first lines; null if that is not known. Its name with the version as it stands
// there.
struct GcodeOrigin {
  const SlicerProfile* slicer = nullptr;
  std::string name;
};

// Prusa's binary container for G-code, which scripts cannot edit.
bool is_binary_gcode(std::string_view gcode);

GcodeOrigin origin_of(std::string_view gcode);

// Reads the comments that this slicer writes; figures that they do not give stay as they are `known`.
GcodeFigures figures_of(std::string_view gcode, const SlicerProfile& slicer, GcodeFigures known = {});

// A line "key = value" of settings, or "; key = value" of those at the end of a G-code; nothing for another
// kind of line.
struct SettingLine {
  std::string_view key;
  std::string_view value;
};
std::optional<SettingLine> setting_in_line(std::string_view line);

// The setting that names programs to be run on the G-code.
inline constexpr const char* kPostProcess = "post_process";

// True for a line of settings that names one.
bool names_post_processing(std::string_view line);

// The value of a setting in the block of settings at the end ("; key = value"), as it stands there.
std::optional<std::string> setting_in(std::string_view gcode, std::string_view key);

// The same G-code with the whole line of a setting replaced by the one of `original`, if both have it.
std::string with_setting_of(std::string gcode, std::string_view original, std::string_view key);

// The same G-code with the pictures for a printer's display that `original` has: a slicer makes them in its
// window only. As it is if `original` has none, or the G-code has its own.
std::string with_thumbnails_of(std::string gcode, std::string_view original);

// A straight move that extrudes: from where to where, mm, and how much filament went through the nozzle.
struct ExtrusionMove {
  double from_x = 0, from_y = 0;
  double x = 0, y = 0, z = 0, filament = 0;
};

// Moves of G0 to G3 that feed filament while moving; absolute and relative coordinates, G92. Arcs (by I, J)
// are cut into chords of at most a millimetre, as far as the text's length allows so many moves; longer ones
// count as straight, and no coordinate is beyond ten kilometres. O(bytes).
std::vector<ExtrusionMove> extrusion_moves(std::string_view gcode);

// Whether there is any such move.
bool extrudes(std::string_view gcode);

// Puts comment lines (";" included) where no reader of G-code minds: after the first line, or after the
// header block of OrcaSlicer. Never inside a block of settings.
std::string with_comments(std::string_view gcode, std::string_view comments);

}  // namespace aerate
