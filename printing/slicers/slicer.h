#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "printing/slicers/gcode.h"

namespace aerate {

enum class SlicerKind { prusa_slicer, orca_slicer, cura_engine, slic3r };

// As on the command line: "prusa-slicer", ...
const char* name_of(SlicerKind kind);

// True if it reads the modifiers of a 3MF (see three_mf.h).
bool takes_modifiers(SlicerKind kind);

// A slicer's command line program.
struct Slicer {
  SlicerKind kind = SlicerKind::prusa_slicer;
  std::filesystem::path program;
};

// The program at `path` or, without one, the first of the slicer's usual names on the search path. Throws
// UsageError that says where was looked.
Slicer find_slicer(SlicerKind kind, const std::filesystem::path& path);

// The user's own settings, whatever the slicer takes them from:
//   PrusaSlicer, Slic3r: .ini files or G-code of the same slicer
//   OrcaSlicer: the JSON files of a machine, a process and filaments
//   CuraEngine: a definition (.def.json), and files of lines "setting=value"
struct SlicerSettings {
  std::vector<std::filesystem::path> files;
};

// Throws InputError for a settings file that cannot be read.
void require_settings(const SlicerSettings& settings);

// True if the settings name programs to be run on the G-code.
bool have_post_processing(const SlicerSettings& settings);

struct SliceJob {
  std::filesystem::path model;  // STL or 3MF, mm
  std::filesystem::path gcode;  // to be written
  SlicerSettings settings;
  bool keep_place = false;        // x and y as in the model instead of the middle of the bed
  std::filesystem::path scratch;  // an existing folder for the slicer's files
};

// In the environment of every slicer that is run here, so that a hook it calls can tell.
inline constexpr const char* kSlicedByVariable = "AERATE_SLICING";

// Slices a model with its settings, but without their post-processing programs, and gives what the slicer
// says of the result. Throws FailureError, with everything the slicer printed, if it fails or leaves no
// G-code.
GcodeFigures slice(const Slicer& slicer, const SliceJob& job, Monitor& monitor);

}  // namespace aerate
