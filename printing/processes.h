#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace aerate {

// The figures that a process sets, in the order of their rows.
enum class Limit {
  wall,            // least thickness between a void and the model's surface
  gap,             // least thickness between two voids
  min_radius,      // smaller voids are not made
  max_radius,      // of the largest voids
  cell_size,       // about how far inner walls between cells are apart
  least_wall,      // a thinner wall cannot be printed at all
  least_gap,       // nor can a thinner gap
  overhang,        // a ceiling flatter than this needs support...
  bridge,          // ...unless it is no wider than this
  channel,         // diameter of a channel that joins two voids
  escape_hole,     // diameter of a hole to the outside
  cup,             // area that a layer may close in over what was printed, where parts are pulled off a film
  plug_clearance,  // between a plug, where it is widest, and its hole all round
  plug_taper,      // by which its side leans away from the hole's
};
inline constexpr std::size_t kLimitCount = 14;

// When a job is under a limit.
enum class LimitGroup {
  packing,   // always; every process has these
  cells,     // where voids are cells and nothing else says how large; they become the largest radius
  printer,   // never: walls, gaps and cups are held against it
  ceilings,  // where the process or the user gives both of these
  drainage,  // where voids drain
  plugs,     // where plugs for the holes are made
};

// No length of a print is beyond this, mm.
inline constexpr double kLongest = 1e5;

struct LimitUnit {
  std::string_view name;
  std::string_view symbol;
  std::string_view placeholder;  // of a value, on the command line
};

// All that there is to say of a limit: the command line, process files and reports have it from here.
struct LimitRow {
  Limit limit;
  LimitGroup group;
  std::string_view name;    // in process files and reports
  std::string_view option;  // on the command line; empty for what a process alone says
  LimitUnit unit;
  std::optional<double> least;   // that may be given; absent: more than 0
  std::string_view explanation;  // for who gives it
  double most = kLongest;
};
std::span<const LimitRow> limit_rows();
const LimitRow& row_of(Limit limit);

// The value of a limit, and where it is from.
struct LimitValue {
  double value = 0;
  std::string source = {};  // who says so; empty for the user
  std::string origin = {};  // in a job: "default of fdm", "command line", "configuration file", ..
};

// Some of the limits: those of a process, those that the user gave, or those that a job is under.
using Limits = std::map<Limit, LimitValue>;

// What happens to the material that a printer leaves in a closed void.
enum class Drainage {
  not_needed,  // there is none
  needed,      // liquid or powder stays in it, unless it is drained
};

// How a kind of printer wants its voids.
struct Process {
  std::string name;
  std::string title;
  std::string material;  // one of materials()
  Drainage drainage = Drainage::not_needed;
  Limits limits;
};

// The built-in processes, the default first.
std::span<const Process> processes();

// The built-in process of this name, or nullptr.
const Process* find_process(std::string_view name);

}  // namespace aerate
