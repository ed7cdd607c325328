#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "core/monitor.h"
#include "files/load.h"
#include "printing/print_settings.h"
#include "printing/slicers/bed.h"
#include "printing/slicers/child_process.h"
#include "printing/slicers/gcode.h"
#include "printing/slicers/object_parts.h"
#include "printing/slicers/slicer_version.h"

namespace aerate {

// The user's own settings, in whatever files the slicer takes them from (SlicerProfile::settings).
struct SlicerSettings {
  std::vector<std::filesystem::path> files;
};

struct SliceJob {
  std::filesystem::path model;  // STL or 3MF, mm
  std::filesystem::path gcode;  // to be written
  SlicerSettings settings;
  std::string pattern = {};  // of sparse infill, instead of that of the settings, if not empty
  bool keep_place = false;   // x and y as in the model instead of the middle of the bed
  // Where the middle of the model's box comes, if the slicer has to be told (place_for()); not with keep_place.
  std::optional<BedPlace> place = {};
  bool says_text = false;         // the slicer knows binary G-code, and has to be told that it writes text
  std::filesystem::path scratch;  // an existing folder for the slicer's files
};

// A figure that a G-code gives in a comment "; label = text" or "; label: text".
struct FigureLine {
  std::string_view label;
  std::optional<double> GcodeFigures::*figure;
  std::optional<double> (*value_of)(std::string_view text);
  bool adds_up = false;  // there is such a line for each extruder
};

// How a slicer keeps the parts of an object, modifiers and support blockers among them, in a file.
struct ModifierFormat {
  std::string flavor;           // as on the command line
  std::string ending = ".3mf";  // of the file
  // How a package says which volumes are none of the model; absent for a file that is not read as a model.
  std::optional<VolumeList> volumes = {};
  // The bytes of a file of a mesh that these parts cover in order; the second may be of support blockers. The object is called as the model's part is if
  // `object_name` is empty.
  std::string (*file)(const Mesh& mesh, const ObjectPart& model, const ObjectPart& voids,
                      const std::string& object_name) = nullptr;
  // The same of a mesh that is one body, so that the slicer calls the object by this name; null where it calls an object
  // by its file.
  std::string (*named)(const Mesh& mesh, const ObjectPart& model, const std::string& object_name) = nullptr;
  // The parts that such a file names. Throws FailureError for one that is not as it was written.
  std::vector<ObjectPart> (*read)(const std::filesystem::path& file) = nullptr;
  // The mesh of such a file, parts in order; null for 3MF, which is read as any model is. Throws FailureError as well.
  Mesh (*read_mesh)(const std::filesystem::path& file) = nullptr;
  std::string elsewhere = {};  // what other slicers make of such a file, and what else to mind, in words
  bool has_lightning = false;  // the infill kLightning
  bool has_blockers = false;   // volumes in which no supports are built
  // How supports are printed that are a part of an object: what takes least of what held (docs/supports.md).
  std::vector<PartSetting> support_settings = {};
};

// An infill pattern that the slicer has for prints that take little.
struct SparsePattern {
  std::string name;      // as in its settings, and on the command line
  std::string good_for;  // in a few words
};

// Supports that the slicer makes, and the settings that ask for them.
struct OwnSupports {
  std::string name;
  std::vector<PartSetting> settings;
  SlicerVersion from;  // the first that has them: others would make their usual ones without a word
};

// A print as a G-code describes it.
struct DescribedPrint {
  PrintSettings settings;
  std::string pattern;          // of sparse infill, as the slicer calls it
  bool is_predictable = false;  // whether that takes what its density says (docs/economics.md)
};

// What a project says of its model beside the mesh.
struct ProjectFacts {
  std::string object_name;               // as the slicer calls the (first) object; empty if it is not said
  std::vector<std::string> beyond_mesh;  // what a mesh does not carry, in words: "painted seams"
  std::string settings;                  // of the whole print, as lines "key = value"
  bool has_unread_settings = false;      // it has others, which are not read
};

// All that is known of a slicer.
struct SlicerProfile {
  std::string name;                 // as on the command line
  std::vector<std::string> family;  // whose G-code and packages are like this slicer's, its own among them
  std::string runs_also;            // one of them that may stand in its place
  bool untested = false;

  std::vector<std::string> programs;  // its names on the search path
  std::vector<std::string> settings;  // kinds of files with settings, in words; each kind in one row
  ChildCommand (*command)(const std::filesystem::path& program, const SliceJob& job) = nullptr;
  // If given: throws InputError for a file of settings that the slicer would take for others in silence.
  void (*check_settings)(const std::filesystem::path& file) = nullptr;
  // If given: makes the slicer write all its settings to `file`, in lines "key = value", after one that names it and its version.
  ChildCommand (*list_settings)(const std::filesystem::path& program,
                                const std::filesystem::path& file) = nullptr;
  // If given: puts the G-code of a run where the job wants it, and gives figures that only its output says.
  GcodeFigures (*collect)(const SliceJob& job, const std::string& printed) = nullptr;

  // What the first lines of a G-code say about who made it; its name with the version begins at the last
  // word.
  std::vector<std::string_view> marks;
  std::vector<FigureLine> figures;
  bool (*begins_layer)(std::string_view comment) = nullptr;
  // Whether the end of a G-code is there, and what it should extrude if it says so: a slicer may not say that its disk was full.
  bool (*is_complete)(std::string_view gcode) = nullptr;
  std::vector<std::string> calls_hook;  // of the family, those that call post-processing scripts
  bool repeats_gcode = false;           // a G-code holds the settings to slice the model once more
  // What the projects say that it keeps as 3MF packages, if that is known. For a package that could be loaded.
  ProjectFacts (*project)(const std::filesystem::path& package) = nullptr;
  // The name of the object in its G-code, if the print is of one and it labels objects.
  std::optional<std::string> (*labelled_object)(std::string_view gcode) = nullptr;

  // From this version on a model stays at its file's coordinates in some files and not in others.
  std::optional<SlicerVersion> needs_place_from;

  // Absent for a slicer that reads no modifiers; voids are surfaces, which all of them take.
  std::optional<ModifierFormat> modifiers;
  // Those that `command` can be asked for, the one that takes least first.
  std::vector<SparsePattern> patterns;
  // If given: what a G-code says that it was printed as; nothing for one that does not say its infill.
  std::optional<DescribedPrint> (*described_print)(std::string_view gcode) = nullptr;
  // If given: whether a G-code says that supports are built wherever they are wanted, so in voids too.
  bool (*supports_everywhere)(std::string_view gcode) = nullptr;
  // Kinds of supports that `command` can be asked for by lines of settings, and what turns all of them off.
  std::vector<OwnSupports> own_supports;
  std::vector<PartSetting> no_supports;
  std::string supports_on_plate;  // the setting, as a line, with which they are built on the plate alone
};

// The rows, each made in a room of its own.
SlicerProfile prusa_slicer();
SlicerProfile orca_slicer();
SlicerProfile cura_engine();
SlicerProfile slic3r();

// All slicers, in the order in which they are listed.
inline const std::vector<SlicerProfile>& slicers() {
  static const std::vector<SlicerProfile> rows{prusa_slicer(), orca_slicer(), cura_engine(), slic3r()};
  return rows;
}

// Where their projects say which volumes are not part of the model.
std::vector<VolumeList> volume_lists();

// What `texts` gives for each slicer, one after the other.
std::vector<std::string> of_slicers(
    const std::function<std::vector<std::string>(const SlicerProfile&)>& texts);

// What a slicer's program says of itself; nothing of it for one that does not tell.
struct SlicerFacts {
  std::optional<SlicerVersion> version;
  std::map<std::string, std::string, std::less<>> settings;  // all that it knows, as they are by default
};

// A slicer's command line program.
struct Slicer {
  const SlicerProfile* profile = nullptr;
  std::filesystem::path program;
  SlicerFacts facts = {};  // if it was asked
};

// The program at `path` or, without one, the first of the slicer's usual names on the search path. Throws
// UsageError that says where was looked.
Slicer find_slicer(const SlicerProfile& profile, const std::filesystem::path& path);

// Throws InputError for a settings file that cannot be read, or that this slicer would not take for what it is.
void require_settings(const SlicerSettings& settings, const SlicerProfile& slicer);

// Runs a slicer to ask for its version and settings. `scratch`: an existing folder.
SlicerFacts ask_slicer(const Slicer& slicer, const std::filesystem::path& scratch, Monitor& monitor);

// Where a slicer that was asked has to put a model, so that each form of it comes to one place: the middle of the bed of these
// settings. Nothing for one that centres whatever it loads.
std::optional<BedPlace> place_for(const Slicer& slicer, const SlicerSettings& settings);

// True if the settings name programs to be run on the G-code.
bool have_post_processing(const SlicerSettings& settings);

// In the environment of every slicer that is run here, so that a hook it calls can tell.
inline constexpr const char* kSlicedByVariable = "AERATE_SLICING";

// Slices a model with its settings, but without their post-processing programs, and gives what the slicer
// says of the result. Throws FailureError, with everything the slicer printed, if it fails or leaves no
// whole G-code.
GcodeFigures slice(const Slicer& slicer, const SliceJob& job, Monitor& monitor);

}  // namespace aerate
