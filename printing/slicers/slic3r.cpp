#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>
#include <utility>

#include "files/output_file.h"
#include "printing/slicers/gcode_machine.h"
#include "printing/slicers/ini_settings.h"
#include "printing/slicers/slicers.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

// "1.5, 2.25" of several extruders.
std::optional<double> sum_of(std::string_view text) {
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
std::optional<double> seconds_of(std::string_view text) {
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

// The volume in "192.5mm (1.4cm3)".
std::optional<double> number_in_brackets(std::string_view text) {
  const std::size_t open = text.find('(');
  return open == std::string_view::npos ? std::nullopt : number_at_front(text.substr(open + 1));
}

bool begins_layer(std::string_view comment) {
  return comment == ";LAYER_CHANGE" || comment == "; CHANGE_LAYER";
}

// "192.5mm (1.4cm3)" and "3.9g" stand behind the same label.
std::optional<double> number_of_unit(std::string_view text, std::string_view unit) {
  const std::optional<double> number = take_number(text);
  return text.starts_with(unit) ? number : std::nullopt;
}
std::optional<double> millimetres_of(std::string_view text) {
  return number_of_unit(text, "mm");
}
std::optional<double> grams_of(std::string_view text) {
  return number_of_unit(text, "g");
}

// Of an extruder, mm: what has gone in, and the most of it, since it may end retracted.
struct Feed {
  double sum = 0, most = 0;
};

// Of all extruders, mm: by the moves, and what Slic3r says.
struct Filament {
  double moved = 0, said = 0;
};

Filament filament_in(std::string_view gcode) {
  constexpr std::string_view kSaid = "; filament used = ";
  Filament filament;
  std::map<int, Feed> extruders;
  Feed* feed = &extruders[0];
  GcodeMachine machine;
  for_each_line(gcode, [&](std::string_view line) {
    machine.run(line);
    if (machine.moved()) {
      feed->sum += machine.filament();
      feed->most = std::max(feed->most, feed->sum);
    } else if (line.starts_with('T')) {
      if (const auto tool = command_word(command_in(line))) feed = &extruders[tool->code];
    } else if (line.starts_with(kSaid)) {
      filament.said += millimetres_of(line.substr(kSaid.size())).value_or(0);
    }
    return true;
  });
  for (const auto& [tool, each] : extruders) filament.moved += each.most;
  return filament;
}

// While the disk is full lines get lost, and when it is no longer the rest is written. G-code of the user's own
// may move more than Slic3r says, and by G91 and G90 change what E means.
bool has_hole(std::string_view gcode) {
  constexpr double kMissing = 0.01;  // relative; measured: none but for the last decimal
  constexpr double kRounding = 0.1;  // mm
  if (gcode.find("\nG91") != std::string_view::npos) return false;
  const Filament filament = filament_in(gcode);
  return filament.moved < filament.said * (1 - kMissing) - kRounding;
}

// The last of its settings is there, and what was to be extruded before.
bool is_complete(std::string_view gcode) {
  return gcode.find("\n; top_solid_layers = ") != std::string_view::npos && ends_with_setting(gcode) &&
         !has_hole(gcode);
}

ChildCommand command_for(const fs::path& program, const SliceJob& job) {
  ChildCommand command{{program}, {}, job.scratch};
  std::size_t number = 0;
  for (const fs::path& file : job.settings.files) {
    // A copy without the programs that would be run on the G-code: Slic3r has no option for that.
    const fs::path copy = job.scratch / fmt::format("settings-{}.ini", number++);
    write_bytes(plain_settings(read_text(file)), copy);
    command.add({"--load", copy});
  }
  if (job.keep_place) command.add({"--dont-arrange"});
  command.add({"--output", job.gcode, job.model});
  return command;
}

ChildCommand list_settings(const fs::path& program, const fs::path& file) {
  return {{program, "--save", file}, {}, file.parent_path()};
}

}  // namespace

SlicerProfile slic3r() {
  SlicerProfile row;
  row.name = "slic3r";
  row.family = {"Slic3r"};
  row.programs = {"slic3r", "Slic3r"};
  row.command = command_for;
  row.check_settings = require_setting_lines;
  row.list_settings = list_settings;
  row.is_complete = is_complete;
  row.marks = {"generated by Slic3r"};
  // Slic3r has a line for each extruder, others one line for all. Those of the slicers that come from it included: old versions of these call themselves Slic3r.
  row.figures = {{"filament used [mm]", &GcodeFigures::filament_mm, sum_of},
                 {"filament used [cm3]", &GcodeFigures::filament_cm3, sum_of},
                 {"filament used [g]", &GcodeFigures::filament_g, sum_of},
                 {"filament cost", &GcodeFigures::cost, sum_of, true},
                 {"estimated printing time (normal mode)", &GcodeFigures::seconds, seconds_of},
                 {"filament used", &GcodeFigures::filament_mm, millimetres_of, true},
                 {"filament used", &GcodeFigures::filament_g, grams_of, true},
                 {"filament used", &GcodeFigures::filament_cm3, number_in_brackets, true}};
  row.begins_layer = begins_layer;
  return row;
}

}  // namespace aerate
