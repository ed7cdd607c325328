#include "printing/slicers/ini_settings.h"

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "files/text_scan.h"
#include "printing/slicers/gcode.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

constexpr const char* kExportSettings = "export the settings in use: File, Export, Export Config";

// Keys are words; comments in G-code that have a "=" are mostly not.
bool is_key(std::string_view text) {
  return !text.empty() &&
         text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") ==
             std::string_view::npos;
}

// A program in it would be run by the slicer, however the key is written.
bool names_programs(std::string_view key) {
  std::string lower(key);
  std::ranges::transform(lower, lower.begin(), to_lower_ascii);
  return lower == kPostProcess;
}

// "prusaslicer_config = begin": no setting, and there twice.
bool marks_block(const SettingLine& setting) {
  return setting.key.ends_with("_config") && (setting.value == "begin" || setting.value == "end");
}

}  // namespace

std::string plain_settings(std::string_view text) {
  text.remove_prefix(start_of_text(text));
  const bool in_comments = origin_of(text).slicer != nullptr;  // G-code, or a project's
  std::string plain;
  for_each_line(text, [&](std::string_view line) {
    line = without_blanks(line);
    if (line.starts_with('#') || line.starts_with(';') != in_comments) return true;
    const auto setting = setting_in_line(line);
    if (in_comments && setting && marks_block(*setting)) return true;
    if (setting && is_key(setting->key) && !names_programs(setting->key))
      plain.append(setting->key).append(" = ").append(setting->value).append("\n");
    return true;
  });
  return plain;
}

void require_no_bundle(std::string_view text, const std::string& file) {
  for_each_line(text.substr(start_of_text(text)), [&](std::string_view line) {
    line = without_blanks(line);
    if (line.starts_with('[') && line.ends_with(']')) {
      throw InputError(
          file + ": is a bundle of presets (" + on_one_line(line) + "), not the settings of a print",
          kExportSettings);
    }
    return true;
  });
}

void require_setting_lines(const std::filesystem::path& file) {
  const auto refuse = [&](const char* what, const char* hint = kExportSettings) {
    throw InputError(file.string() + ": " + what, hint);
  };
  const std::string text = read_text(file);
  const std::string_view content = without_blanks(std::string_view(text).substr(start_of_text(text)));
  if (content.empty()) refuse("is empty, and the slicer would print with its defaults");
  if (content.starts_with("PK\x03\x04"))
    refuse("is a project or another archive, which is not read as settings",
           "give the project as the model, or export its settings: File, Export, Export Config");
  if (is_binary_gcode(content))
    refuse("is binary G-code, whose settings are packed",
           "switch binary G-code off in the slicer's printer settings, or export the settings");
  if (content.starts_with('{')) refuse("is JSON, and not settings of this slicer");
  require_no_bundle(content, file.string());
  if (plain_settings(text).empty()) refuse("holds no settings, and the slicer would print with its defaults");
}

bool ends_with_setting(std::string_view gcode) {
  if (!gcode.ends_with('\n')) return false;
  gcode = without_blanks(gcode);
  const std::string_view last = gcode.substr(gcode.rfind('\n') + 1);
  const auto setting = setting_in_line(last);
  return last.starts_with(';') && setting && is_key(setting->key);
}

}  // namespace aerate
