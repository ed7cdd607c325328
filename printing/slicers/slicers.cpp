#include "printing/slicers/slicers.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fmt/ranges.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <unistd.h>

#include "core/error.h"
#include "printing/slicers/ini_settings.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

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

[[noreturn]] void fail(const Slicer& slicer, const SliceJob& job, const std::string& why,
                       std::string printed) {
  while (!printed.empty() && printed.back() == '\n') printed.pop_back();
  throw FailureError(fmt::format("{} {} on {}", slicer.profile->name, why, job.model.filename().string()) +
                     (printed.empty() ? "; it printed nothing" : "; it printed:\n" + printed));
}

// In words, where there is so little that it may be why.
std::string space_left(const fs::path& file) {
  constexpr std::uintmax_t kPlenty = 16 << 20;
  std::error_code error;
  const fs::space_info space = fs::space(file.parent_path(), error);
  if (error || space.available > kPlenty) return "";
  return fmt::format(" (there are {} kB left in {}: set TMPDIR to a folder with more)",
                     space.available / 1024, file.parent_path().string());
}

// Of OrcaSlicer: one text, or a list of them.
bool json_names_post_processing(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains(kPostProcess)) return false;
  const nlohmann::json& value = json[kPostProcess];
  const auto names_one = [](const nlohmann::json& each) {
    return each.is_string() && !without_blanks(each.get_ref<const std::string&>()).empty();
  };
  return value.is_array() ? std::ranges::any_of(value, names_one) : names_one(value);
}

}  // namespace

std::vector<VolumeList> volume_lists() {
  std::vector<VolumeList> lists;
  for (const SlicerProfile& slicer : slicers()) {
    if (slicer.modifiers && slicer.modifiers->volumes) lists.push_back(*slicer.modifiers->volumes);
  }
  return lists;
}

std::vector<std::string> of_slicers(
    const std::function<std::vector<std::string>(const SlicerProfile&)>& texts) {
  std::vector<std::string> all;
  for (const SlicerProfile& slicer : slicers()) {
    for (std::string& text : texts(slicer)) all.push_back(std::move(text));
  }
  return all;
}

Slicer find_slicer(const SlicerProfile& profile, const fs::path& path) {
  if (!path.empty()) {
    if (!is_program(path))
      throw UsageError(path.string() + ": is not a program that can be run",
                       "give the slicer's program as --slicer-path");
    return {&profile, fs::absolute(path)};
  }
  for (const std::string& name : profile.programs) {
    for (const fs::path& folder : search_path()) {
      if (is_program(folder / name)) return {&profile, folder / name};
    }
  }
  throw UsageError(
      fmt::format("{} is not on the search path (as {})", profile.name, fmt::join(profile.programs, " ")),
      "install it, or give its program as --slicer-path");
}

void require_settings(const SlicerSettings& settings, const SlicerProfile& slicer) {
  for (const fs::path& file : settings.files) {
    std::error_code error;
    if (!fs::is_regular_file(file, error) || !std::ifstream(file))
      throw InputError(file.string() + ": no settings can be read from it",
                       "give the slicer's own settings file");
    if (slicer.check_settings != nullptr) slicer.check_settings(file);
  }
}

SlicerFacts ask_slicer(const Slicer& slicer, const fs::path& scratch, Monitor& monitor) {
  SlicerFacts facts;
  if (slicer.profile->list_settings == nullptr) return facts;
  const fs::path file = scratch / "all-settings.ini";
  ChildCommand command = slicer.profile->list_settings(slicer.program, file);
  command.environment.emplace_back(kSlicedByVariable, "1");
  std::error_code error;
  if (run_child(command, monitor).exit_code != 0 || !fs::is_regular_file(file, error)) return facts;
  const std::string text = read_text(file);
  for (const std::string& program : slicer.profile->family)
    if (!facts.version) facts.version = version_of(program, text);
  for_each_line(text, [&](std::string_view line) {
    if (const auto setting = setting_in_line(line); setting && !line.starts_with('#'))
      facts.settings.insert_or_assign(std::string(setting->key), std::string(setting->value));
    return true;
  });
  return facts;
}

std::optional<BedPlace> place_for(const Slicer& slicer, const SlicerSettings& settings) {
  const auto& from = slicer.profile->needs_place_from;
  if (!from || !slicer.facts.version || *slicer.facts.version < *from) return std::nullopt;
  constexpr std::string_view kBed = "bed_shape";
  const auto own = slicer.facts.settings.find(kBed);
  std::string corners = own == slicer.facts.settings.end() ? "" : own->second;
  for (const fs::path& file : settings.files) {  // later ones win
    for_each_line(plain_settings(read_text(file)), [&](std::string_view line) {
      if (const auto setting = setting_in_line(line); setting && setting->key == kBed)
        corners = setting->value;
      return true;
    });
  }
  return middle_of_bed(corners);
}

bool have_post_processing(const SlicerSettings& settings) {
  bool found = false;
  for (const fs::path& file : settings.files) {
    const std::string text = read_text(file);
    found = found || json_names_post_processing(text);
    for_each_line(text, [&](std::string_view line) {
      found = found || names_post_processing(line);
      return !found;
    });
  }
  return found;
}

GcodeFigures slice(const Slicer& slicer, const SliceJob& job, Monitor& monitor) {
  ChildCommand command = slicer.profile->command(slicer.program, job);
  command.environment.emplace_back(kSlicedByVariable, "1");
  const ChildOutcome outcome = run_child(command, monitor);
  if (outcome.exit_code != 0)
    fail(slicer, job, fmt::format("failed with status {}", outcome.exit_code), outcome.printed);

  GcodeFigures known;
  if (slicer.profile->collect != nullptr) known = slicer.profile->collect(job, outcome.printed);
  std::error_code error;
  if (!fs::is_regular_file(job.gcode, error) || fs::file_size(job.gcode, error) == 0)
    fail(slicer, job, "wrote no G-code", outcome.printed);
  const std::string text = read_text(job.gcode);
  if (is_binary_gcode(text))
    fail(slicer, job, "wrote binary G-code, which cannot be read here: set binary_gcode = 0",
         outcome.printed);
  if (!extrudes(text)) fail(slicer, job, "wrote G-code that extrudes nothing", outcome.printed);
  if (!slicer.profile->is_complete(text))
    fail(slicer, job, "wrote G-code whose end is missing" + space_left(job.gcode), outcome.printed);
  return figures_of(text, *slicer.profile, known);
}

}  // namespace aerate
