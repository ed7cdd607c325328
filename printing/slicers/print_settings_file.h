#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "printing/print_settings.h"
#include "printing/slicers/slicer_version.h"

namespace aerate {

// What a file of a slicer may say of a print.
enum class PrintSetting {
  infill,
  pattern,
  perimeters,
  line_width,
  layer_height,
  top_layers,
  bottom_layers,
  // Of PrusaSlicer from 2.6 on; which version it is decides whose rules hold.
  slicer_version,
  vertical_shells,
  walls,
};

// A print as far as it is known otherwise.
struct KnownPrintSettings {
  PrintSettings settings;
  std::set<PrintSetting> which;  // of these; a file's are not looked at
};

// A print as far as a slicer's file describes it.
struct FoundPrintSettings {
  PrintSettings settings;                    // those known, else the file's, else defaults
  std::map<PrintSetting, std::string> keys;  // what was taken from the file, as the slicer calls it
  std::vector<std::string> remarks;          // what a user should know about them
};

// The rules of a version of PrusaSlicer.
SolidRules rules_of(const SlicerVersion& version);

// "enabled", "partial" or "disabled"; 1 and 0 of older versions are read as newer ones do.
std::optional<VerticalShells> parse_vertical_shells(std::string_view text);

// "arachne" or "classic"
std::optional<WallGenerator> parse_walls(std::string_view text);

// Reads what a slicer exports: settings (.ini of PrusaSlicer, SuperSlicer and Slic3r; JSON of OrcaSlicer and Bambu
// Studio) or G-code, which ends with them. `file`: how messages call it. Throws InputError, with what the text is and what
// to do, for one that has no such settings or says what is not known here.
FoundPrintSettings print_settings_in(std::string_view text, const std::string& file,
                                     const KnownPrintSettings& known = {});

// The same of a file, which may also be a project of these slicers (3MF).
FoundPrintSettings read_print_settings(const std::filesystem::path& file,
                                       const KnownPrintSettings& known = {});

}  // namespace aerate
