#include "printing/slicers/ini_settings.h"

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "files/text_scan.h"
#include "printing/slicers/gcode.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

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

void require_no_bundle(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  for_each_line(std::string_view(text).substr(start_of_text(text)), [&](std::string_view line) {
    line = without_blanks(line);
    if (line.starts_with('[') && line.ends_with(']')) {
      throw InputError(
          file.string() + ": is a bundle of presets (" + on_one_line(line) + "), not the settings of a print",
          "export the settings in use: File, Export, Export Config");
    }
    return true;
  });
}

bool ends_with_setting(std::string_view gcode) {
  if (!gcode.ends_with('\n')) return false;
  gcode = without_blanks(gcode);
  const std::string_view last = gcode.substr(gcode.rfind('\n') + 1);
  const auto setting = setting_in_line(last);
  return last.starts_with(';') && setting && is_key(setting->key);
}

}  // namespace aerate
