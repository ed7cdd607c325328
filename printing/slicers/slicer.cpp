#include "printing/slicers/slicer.h"

#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>
#include <unistd.h>

#include "core/error.h"
#include "files/output_file.h"
#include "printing/slicers/child_process.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCuraDefinition = "/usr/share/cura/resources/definitions/fdmprinter.def.json";
constexpr const char* kCuraSearchPath = "CURA_ENGINE_SEARCH_PATH";

std::vector<std::string> program_names(SlicerKind kind) {
  switch (kind) {
    case SlicerKind::prusa_slicer:
      return {"prusa-slicer", "PrusaSlicer", "prusa-slicer-console", "superslicer", "SuperSlicer"};
    case SlicerKind::orca_slicer:
      return {"orca-slicer", "OrcaSlicer"};
    case SlicerKind::cura_engine:
      return {"CuraEngine", "cura-engine", "curaengine"};
    case SlicerKind::slic3r:
      return {"slic3r", "Slic3r"};
  }
  return {};
}

bool is_program(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

std::vector<fs::path> search_path() {
  std::vector<fs::path> folders;
  const char* variable = std::getenv("PATH");
  std::istringstream stream(variable != nullptr ? variable : "");
  for (std::string folder; std::getline(stream, folder, ':');)
    folders.emplace_back(folder.empty() ? "." : folder);
  return folders;
}

// Value of "key = value" at the beginning of a line; "; key = value" in the settings of a G-code.
std::string_view key_of(std::string_view line) {
  if (line.starts_with("; ")) line.remove_prefix(2);
  line = line.substr(0, line.find('='));
  while (line.ends_with(' ') || line.ends_with('\t')) line.remove_suffix(1);
  return line;
}

bool names_post_processing(std::string_view line) {
  if (key_of(line) != "post_process") return false;
  const std::size_t equals = line.find('=');
  return equals != std::string_view::npos &&
         line.find_first_not_of(" \t\r\n\"", equals + 1) != std::string_view::npos;
}

// A copy without the programs that would be run on the G-code: Slic3r has no option for that.
fs::path without_post_processing(const fs::path& settings, const fs::path& copy) {
  std::istringstream in(read_text(settings));
  std::string kept;
  for (std::string line; std::getline(in, line);) {
    if (!names_post_processing(line)) kept.append(line).append("\n");
  }
  write_bytes(kept, copy);
  return copy;
}

bool is_filament(const fs::path& settings) {
  std::string text = read_text(settings);
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; });
  return text.find("\"type\":\"filament\"") != std::string::npos;
}

std::string joined(const std::vector<std::string>& texts, char separator) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : std::string(1, separator)) + text;
  return all;
}

ChildCommand prusa_slicer_command(const Slicer& slicer, const SliceJob& job) {
  ChildCommand command{{slicer.program, "--export-gcode"}, {}, job.scratch};
  for (const fs::path& file : job.settings.files) {
    command.arguments.emplace_back("--load");
    command.arguments.push_back(file);
  }
  if (job.keep_place) command.arguments.emplace_back("--dont-arrange");
  for (const std::string& argument : {std::string("--post-process"), std::string(), std::string("--output"),
                                      job.gcode.string(), job.model.string()})
    command.arguments.push_back(argument);
  return command;
}

ChildCommand slic3r_command(const Slicer& slicer, const SliceJob& job) {
  ChildCommand command{{slicer.program}, {}, job.scratch};
  std::size_t number = 0;
  for (const fs::path& file : job.settings.files) {
    const fs::path copy = job.scratch / ("settings-" + std::to_string(number++) + ".ini");
    command.arguments.emplace_back("--load");
    command.arguments.push_back(without_post_processing(file, copy));
  }
  if (job.keep_place) command.arguments.emplace_back("--dont-arrange");
  for (const std::string& argument : {std::string("--output"), job.gcode.string(), job.model.string()})
    command.arguments.push_back(argument);
  return command;
}

ChildCommand orca_slicer_command(const Slicer& slicer, const SliceJob& job) {
  ChildCommand command{{slicer.program, "--slice", "0", "--outputdir", job.scratch}, {}, job.scratch};
  std::vector<std::string> filaments, others;
  for (const fs::path& file : job.settings.files) (is_filament(file) ? filaments : others).push_back(file);
  if (!others.empty()) {
    command.arguments.emplace_back("--load-settings");
    command.arguments.push_back(joined(others, ';'));
  }
  if (!filaments.empty()) {
    command.arguments.emplace_back("--load-filaments");
    command.arguments.push_back(joined(filaments, ';'));
  }
  command.arguments.push_back(job.model);
  return command;
}

bool is_definition(const fs::path& file) {
  return file.string().ends_with(".def.json");
}

// CuraEngine looks for what a definition inherits in folders that a variable names.
std::string cura_search_path(const fs::path& definition) {
  const char* given = std::getenv(kCuraSearchPath);
  const fs::path folder = fs::absolute(definition).parent_path();
  return (given != nullptr ? std::string(given) + ":" : std::string()) + folder.string() + ":" +
         (folder.parent_path() / "extruders").string();
}

ChildCommand cura_engine_command(const Slicer& slicer, const SliceJob& job) {
  fs::path definition = kCuraDefinition;
  std::vector<std::string> settings;
  for (const fs::path& file : job.settings.files) {
    if (is_definition(file)) {
      definition = file;
      continue;
    }
    std::istringstream lines(read_text(file));
    for (std::string line; std::getline(lines, line);) {
      const std::size_t equals = line.find('=');
      if (line.empty() || line.starts_with('#') || line.starts_with('[') || equals == std::string::npos)
        continue;
      const std::size_t value = std::min(line.find_first_not_of(" \t", equals + 1), line.size());
      const std::size_t end = line.find_last_not_of(" \t\r") + 1;
      settings.emplace_back("-s");
      settings.push_back(std::string(key_of(line)) + "=" + line.substr(value, std::max(end, value) - value));
    }
  }
  ChildCommand command{{slicer.program, "slice", "-v", "-j", definition},
                       {{kCuraSearchPath, cura_search_path(definition)}},
                       job.scratch};
  // Settings after -j are the machine's; the model's own follow -l.
  for (const std::string& setting : settings) command.arguments.push_back(setting);
  for (const std::string& argument :
       {std::string("-o"), job.gcode.string(), std::string("-l"), job.model.string()})
    command.arguments.push_back(argument);
  return command;
}

ChildCommand command_for(const Slicer& slicer, const SliceJob& job) {
  switch (slicer.kind) {
    case SlicerKind::prusa_slicer:
      return prusa_slicer_command(slicer, job);
    case SlicerKind::orca_slicer:
      return orca_slicer_command(slicer, job);
    case SlicerKind::cura_engine:
      return cura_engine_command(slicer, job);
    case SlicerKind::slic3r:
      return slic3r_command(slicer, job);
  }
  throw FailureError("unknown slicer");
}

// CuraEngine writes a header before it knows the figures, and prints the true one; Cura puts that in.
void replace_cura_header(const fs::path& gcode, std::string_view printed) {
  constexpr std::string_view kBegin = "Gcode header after slicing:\n", kEnd = "End of gcode header.";
  const std::size_t begin = printed.find(kBegin), end = printed.find(kEnd);
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return;
  const std::string_view header = printed.substr(begin + kBegin.size(), end - begin - kBegin.size());
  std::string text = read_text(gcode);
  const std::size_t old_end = text.find("\n\n");
  if (!text.starts_with(";FLAVOR") || old_end == std::string::npos) return;
  text.replace(0, old_end + 1, header);
  write_bytes(text, gcode);
}

[[noreturn]] void fail(const Slicer& slicer, const SliceJob& job, const std::string& why,
                       std::string printed) {
  while (!printed.empty() && printed.back() == '\n') printed.pop_back();
  throw FailureError(std::string(name_of(slicer.kind)) + " " + why + " on " + job.model.filename().string() +
                     (printed.empty() ? "; it printed nothing" : "; it printed:\n" + printed));
}

}  // namespace

const char* name_of(SlicerKind kind) {
  switch (kind) {
    case SlicerKind::prusa_slicer:
      return "prusa-slicer";
    case SlicerKind::orca_slicer:
      return "orca-slicer";
    case SlicerKind::cura_engine:
      return "cura-engine";
    case SlicerKind::slic3r:
      return "slic3r";
  }
  return "unknown";
}

bool takes_modifiers(SlicerKind kind) {
  return kind == SlicerKind::prusa_slicer || kind == SlicerKind::orca_slicer;
}

Slicer find_slicer(SlicerKind kind, const fs::path& path) {
  if (!path.empty()) {
    if (!is_program(path))
      throw UsageError(path.string() + ": is not a program that can be run",
                       "give the slicer's program as --slicer-path");
    return {kind, fs::absolute(path)};
  }
  const std::vector<std::string> names = program_names(kind);
  for (const std::string& name : names) {
    for (const fs::path& folder : search_path()) {
      if (is_program(folder / name)) return {kind, folder / name};
    }
  }
  throw UsageError(std::string(name_of(kind)) + " is not on the search path (as " + joined(names, ' ') + ")",
                   "install it, or give its program as --slicer-path");
}

void require_settings(const SlicerSettings& settings) {
  for (const fs::path& file : settings.files) {
    std::error_code error;
    if (!fs::is_regular_file(file, error) || !std::ifstream(file))
      throw InputError(file.string() + ": no settings can be read from it",
                       "give the slicer's own settings file");
  }
}

bool have_post_processing(const SlicerSettings& settings) {
  for (const fs::path& file : settings.files) {
    std::istringstream lines(read_text(file));
    for (std::string line; std::getline(lines, line);) {
      if (names_post_processing(line)) return true;
    }
  }
  return false;
}

GcodeFigures slice(const Slicer& slicer, const SliceJob& job, Monitor& monitor) {
  ChildCommand command = command_for(slicer, job);
  command.environment.emplace_back(kSlicedByVariable, "1");
  const ChildOutcome outcome = run_child(command, monitor);
  if (outcome.exit_code != 0)
    fail(slicer, job, "failed with status " + std::to_string(outcome.exit_code), outcome.printed);

  std::error_code error;
  if (slicer.kind == SlicerKind::orca_slicer)
    fs::rename(job.scratch / "plate_1.gcode", job.gcode, error);  // its name cannot be chosen
  if (!fs::is_regular_file(job.gcode, error) || fs::file_size(job.gcode, error) == 0)
    fail(slicer, job, "wrote no G-code", outcome.printed);
  if (slicer.kind == SlicerKind::cura_engine) replace_cura_header(job.gcode, outcome.printed);
  const std::string text = read_text(job.gcode);
  if (is_binary_gcode(text))
    fail(slicer, job, "wrote binary G-code, which cannot be read here: set binary_gcode = 0",
         outcome.printed);
  if (!extrudes(text)) fail(slicer, job, "wrote G-code that extrudes nothing", outcome.printed);
  GcodeFigures figures = figures_of(text);
  if (slicer.kind == SlicerKind::cura_engine) {
    constexpr std::string_view kVolume = "Filament (mm^3): ";
    constexpr double kCubicMillimetresPerCm3 = 1000;
    const std::size_t at = outcome.printed.find(kVolume);
    if (at != std::string::npos)
      figures.filament_cm3 =
          std::strtod(outcome.printed.c_str() + at + kVolume.size(), nullptr) / kCubicMillimetresPerCm3;
  }
  return figures;
}

}  // namespace aerate
