#pragma once

#include <filesystem>
#include <string>
#include <string_view>

// Settings as Slic3r and the slicers that come from it write them: lines "key = value" in .ini files, the same as
// comments in G-code and projects.
namespace aerate {

// The settings of a file as this program reads them, in plain lines "key = value", without those that name
// programs to be run on the G-code: whatever else is in the text, a slicer sees no more than these.
std::string plain_settings(std::string_view text);

// Throws InputError for a bundle of presets ("[print:name]"), of which slicers read nothing when they are given it
// as settings, so that they print with their defaults. `file`: how messages call the text.
void require_no_bundle(std::string_view text, const std::string& file);

// Throws InputError for a file that holds no settings in such lines, of which slicers may say nothing either: a bundle,
// an empty file, a project, binary G-code, JSON.
void require_setting_lines(const std::filesystem::path& file);

// Whether the last line of a G-code is one of its settings, and whole.
bool ends_with_setting(std::string_view gcode);

}  // namespace aerate
