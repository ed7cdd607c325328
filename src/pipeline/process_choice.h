#pragma once

#include <string>
#include <vector>

#include "core/monitor.h"
#include "core/packing.h"
#include "printing/processes.h"

namespace aerate {

// A limit that was used, and where it came from.
struct LimitOrigin {
  Limit limit = Limit::wall;
  double value = 0;
  std::string origin;  // "default of fdm", "command line", "configuration file"
  std::string source;  // for a default: who says so
  bool is_default = false;
};

// Which way is up while a model is printed.
struct PrintDirection {
  Vec3d up{0, 0, 1};
  std::string name = "+z";
  std::string origin = "default";
};

// The process a job is for, and where each limit that it is done under came from. Overhang and bridge are
// among them where ceilings are limited, the diameters of channels and escape holes where voids drain.
struct ProcessChoice {
  Process process;
  std::vector<LimitOrigin> origins;
  PrintDirection direction = {};
};

// The limits that the origins name, and the roofs that follow from them. Throws UsageError for an overhang, a
// bridge or a direction that makes no roof.
PackingLimits packing_limits(const ProcessChoice& choice);

// The built-in process of this name or, for a name that ends in .json or holds a slash, that of the file.
// Throws UsageError for an unknown name, and what read_process_file throws.
Process choose_process(const std::string& name_or_file);

// A limit that the user gave instead of the process's.
struct GivenLimit {
  Limit limit = Limit::wall;
  double value = 0;
  std::string origin;
};

// Whether limits that the process cannot print are refused.
enum class ProcessCheck {
  none,    // the process was not asked for by name
  strict,  // refuse
};

// The process's limits with those given in their place. Throws UsageError for limits that contradict each
// other or that this process cannot print, and for an overhang without a bridge or the other way round.
ProcessChoice limits_under(const Process& process, const std::vector<GivenLimit>& given, ProcessCheck check);

// For a lattice, whose balls have no room for roofs: unless the user gave the largest radius, it becomes that
// of the largest balls that need none.
void keep_to_balls_without_roofs(ProcessChoice& choice);

// What the user should know about sealed voids in this process, if anything.
void warn_of_trapped_material(const Process& process, Monitor& monitor);

// Every built-in process with its figures and their sources, for people.
std::string processes_in_words();

}  // namespace aerate
