#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/drainage.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "printing/print_settings.h"
#include "printing/processes.h"

namespace aerate {

// Whether the part stands on its plate while it is printed, or hangs from it (printers that cure each layer through a film
// below the part). It grows along `up` either way; of a hanging part gravity points along `up`.
enum class Build { standing, hanging };
const char* name_of(Build build);

// Which way is up while a model is printed.
struct PrintDirection {
  Vec3d up{0, 0, 1};
  std::string name = "+z";
  std::string origin = "default";
};

// The process a job is for, and the limits that it is done under. Overhang and bridge are among them where
// ceilings are limited, the diameters of channels and escape holes where voids drain.
struct ProcessChoice {
  Process process;
  Limits limits;
  PrintDirection direction = {};
};

// The file that --process chooses: the path that it is if it ends in .json or holds a slash, else the one of this name in the
// user's configuration folder (pipeline/own_processes.h). Empty for a built-in process, which goes first, and for unknown
// names.
std::filesystem::path process_file_of(const std::string& name_or_file);

// The built-in process of this name, or that of the file.
// Throws UsageError for an unknown name, and what read_process_file throws.
Process choose_process(const std::string& name_or_file);

// Whether limits that the process cannot print are refused.
enum class ProcessCheck {
  none,    // the process was not asked for by name
  strict,  // refuse
};

// The process's limits with those given in their place. Throws UsageError for limits that contradict each
// other or that this process cannot print, and for an overhang without a bridge or the other way round.
ProcessChoice limits_under(const Process& process, const Limits& given, ProcessCheck check);

// For a lattice, whose balls have no room for roofs: unless the user gave the largest radius, it becomes that
// of the largest balls that need none.
ProcessChoice kept_to_balls_without_roofs(ProcessChoice choice);

// For voids that are cells: inner walls about `cell_size` mm apart, which is what the largest radius becomes. Unless it or
// that radius is given, the process's own size; of a process without one, its largest voids, but no larger than those of
// cells of 21 mm with a gap of 1 mm. Throws UsageError for a size that leaves no radius, or if a largest radius was given
// beside it.
ProcessChoice sized_for_cells(ProcessChoice choice, std::optional<double> cell_size);

// A choice that was sized for cells, with cells twice as large.
ProcessChoice with_larger_cells(ProcessChoice choice);

// The same with cells round spheres no larger than the process's; nullopt if they are not larger.
std::optional<ProcessChoice> with_smaller_cells(ProcessChoice choice);

// A choice that was not sized for cells yet, with the process's own wall, gap and radii where those that were given allow
// more. Results under it obey what was given. nullopt if none does.
//   makes_cells: the largest radius is that of the process's cells
std::optional<ProcessChoice> with_usual_limits(const ProcessChoice& choice, bool makes_cells);

// The same, with evenly large spheres, whose cells take more than those of many small ones beside large ones: unless
// the user gave the least radius, it becomes half of the largest that there will be, `fitting` or the limit.
ProcessChoice evenly_large(ProcessChoice choice, double fitting);

// Whether a limit is what the process gives.
bool is_default(const ProcessChoice& choice, Limit limit);

// Whether the process's least radius was halved with the largest one, for cells of --cell-size.
bool is_lowered_for_cells(const ProcessChoice& choice);

// For voids that become modifiers, round which the slicer prints the walls it prints anyway: unless the user or a process
// file gave the wall, it is as thick as these. What lies between would be filled by a strip of infill that carries nothing.
ProcessChoice walled_by_perimeters(ProcessChoice choice, const PrintSettings& settings);

// For a built-in process that prints lines whose width is known, mm: unless the user gave them, its wall is as thick as
// three of these and its gap as two. `origin`: where the width came from.
ProcessChoice followed_by_lines(ProcessChoice choice, double line_width, const std::string& origin);

// For modifiers with an infill that holds up what is above them: unless the user or a process file gave them, no limits of
// ceilings.
ProcessChoice held_up_by_infill(ProcessChoice choice);

// The same job with voids that drain: under the limits of tubes too, those given or the process's. Throws
// UsageError if one is neither, or if holes are narrower than channels.
ProcessChoice with_tubes(ProcessChoice choice, const Limits& given);

// The same with plugs for the holes: under their limits too. Throws UsageError if one is not to be had.
ProcessChoice with_plugs(ProcessChoice choice, const Limits& given);

// What packers are to keep to, and the roofs that follow from it. Throws UsageError for an overhang, a bridge
// or a direction that makes no roof.
PackingLimits packing_limits(const ProcessChoice& choice);

// What is asked of the drainage of a choice with tubes. `escape_holes`: where they are to open.
DrainageRequest drainage_request(const ProcessChoice& choice, std::vector<Vec3d> escape_holes);

// What the user should know about sealed voids in this process, if anything.
void warn_of_trapped_material(const Process& process, Monitor& monitor);

// "fdm, sla, sls, metal"
std::string process_names();

// The built-in processes that meet a condition, as in a sentence: "sla, sls and metal".
std::string processes_that(const std::function<bool(const Process&)>& condition);

// Every built-in process with its figures and their sources, for people; then those of the user's configuration folder, with
// their files, or what is wrong with them.
std::string processes_in_words();

}  // namespace aerate
