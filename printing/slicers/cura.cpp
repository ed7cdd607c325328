#include <cstdlib>

#include "core/error.h"
#include "files/output_file.h"
#include "printing/slicers/slicers.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDefinition = "/usr/share/cura/resources/definitions/fdmprinter.def.json";
constexpr const char* kSearchPath = "CURA_ENGINE_SEARCH_PATH";

bool is_definition(const fs::path& file) {
  return file.string().ends_with(".def.json");
}

// The engine is given what is found in lines, and nothing of a file without any.
void require_some_settings(const fs::path& file) {
  const std::string text = read_text(file);
  bool has_some = is_definition(file) && !without_blanks(text).empty();
  for_each_line(text, [&](std::string_view line) {
    has_some = has_some || (setting_in_line(line) && !line.starts_with('#') && !line.starts_with('['));
    return !has_some;
  });
  if (!has_some)
    throw InputError(file.string() + ": holds no settings, and the engine would print with its defaults",
                     "give a .def.json, or lines setting=value");
}

// CuraEngine looks for what a definition inherits in folders that a variable names.
std::string search_path(const fs::path& definition) {
  const char* given = std::getenv(kSearchPath);
  const fs::path folder = fs::absolute(definition).parent_path();
  return (given != nullptr ? std::string(given) + ":" : std::string()) + folder.string() + ":" +
         (folder.parent_path() / "extruders").string();
}

ChildCommand command_for(const fs::path& program, const SliceJob& job) {
  fs::path definition = kDefinition;
  std::vector<std::string> settings;
  for (const fs::path& file : job.settings.files) {
    if (is_definition(file)) {
      definition = file;
      continue;
    }
    for_each_line(read_text(file), [&](std::string_view line) {
      const auto setting = setting_in_line(line);
      if (setting && !line.starts_with('#') && !line.starts_with('['))
        settings.insert(settings.end(),
                        {"-s", std::string(setting->key) + "=" + std::string(setting->value)});
      return true;
    });
  }
  ChildCommand command{
      {program, "slice", "-v", "-j", definition}, {{kSearchPath, search_path(definition)}}, job.scratch};
  // Settings after -j are the machine's; the model's own follow -l.
  for (const std::string& setting : settings) command.add({setting});
  command.add({"-o", job.gcode, "-l", job.model});
  return command;
}

// CuraEngine writes a header before it knows the figures, and prints the true one; Cura puts that in.
void replace_header(const fs::path& gcode, std::string_view printed) {
  constexpr std::string_view kBegin = "Gcode header after slicing:\n", kEnd = "End of gcode header.";
  const std::size_t begin = printed.find(kBegin), end = printed.find(kEnd);
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return;
  std::string header;
  for_each_line(printed.substr(begin + kBegin.size(), end - begin - kBegin.size()),
                [&](std::string_view line) {
                  if (line.starts_with(';')) header.append(line).append("\n");
                  return true;
                });
  std::string text = read_text(gcode);
  const std::size_t old_end = text.find("\n\n");
  if (!text.starts_with(";FLAVOR") || old_end == std::string::npos) return;
  text.replace(0, old_end + 1, header);
  write_bytes(text, gcode);
}

GcodeFigures collect(const SliceJob& job, const std::string& printed) {
  constexpr std::string_view kVolume = "Filament (mm^3): ";
  constexpr double kCubicMillimetresPerCm3 = 1000;
  GcodeFigures figures;
  std::error_code error;
  if (fs::exists(job.gcode, error)) replace_header(job.gcode, printed);
  if (const std::size_t at = printed.find(kVolume); at != std::string::npos)
    figures.filament_cm3 =
        std::strtod(printed.c_str() + at + kVolume.size(), nullptr) / kCubicMillimetresPerCm3;
  return figures;
}

// "0.228916m, 1.5m" of several extruders.
std::optional<double> length_of(std::string_view text) {
  constexpr double kMillimetresPerMetre = 1000;
  double metres = 0;
  while (const std::optional<double> length = take_number(text)) {
    metres += *length;
    if (text.starts_with('m')) text.remove_prefix(1);
    if (text.starts_with(',')) text.remove_prefix(1);
  }
  return metres * kMillimetresPerMetre;
}

// Before the settings that Cura itself puts behind it.
bool is_complete(std::string_view gcode) {
  return gcode.find("\n;End of Gcode") != std::string_view::npos;
}

bool begins_layer(std::string_view comment) {
  return comment.starts_with(";LAYER:");
}

}  // namespace

SlicerProfile cura_engine() {
  SlicerProfile row;
  row.name = "cura-engine";
  row.family = {"Cura"};
  row.programs = {"CuraEngine", "cura-engine", "curaengine"};
  row.settings = {".def.json and lines name=value (CuraEngine)"};
  row.command = command_for;
  row.check_settings = require_some_settings;
  row.collect = collect;
  row.marks = {"Generated with Cura"};
  row.figures = {{"Filament used", &GcodeFigures::filament_mm, length_of},
                 {"TIME", &GcodeFigures::seconds, number_at_front}};
  row.begins_layer = begins_layer;
  row.is_complete = is_complete;
  return row;
}

}  // namespace aerate
