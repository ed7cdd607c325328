#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/packing.h"

namespace aerate {

// The figures that a process sets. Lengths in mm; `overhang` in degrees from the vertical.
enum class Limit {
  wall,         // least thickness between a void and the model's surface
  gap,          // least thickness between two voids
  min_radius,   // smaller voids are not made
  max_radius,   // of the largest voids
  least_wall,   // a thinner wall cannot be printed at all
  least_gap,    // nor can a thinner gap
  overhang,     // a ceiling flatter than this needs support...
  bridge,       // ...unless it is no wider than this
  channel,      // diameter of a channel that joins two voids
  escape_hole,  // diameter of a hole to the outside
};
inline constexpr std::size_t kLimitCount = 10;

// As on the command line and in a process file: "min-radius".
std::string_view name_of(Limit limit);
std::optional<Limit> limit_named(std::string_view name);
std::string_view unit_of(Limit limit);

// A figure, and who says so.
struct SourcedValue {
  double value = 0;
  std::string source;
};

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
  std::array<std::optional<SourcedValue>, kLimitCount> limits;

  const std::optional<SourcedValue>& operator[](Limit limit) const {
    return limits[static_cast<std::size_t>(limit)];
  }
  std::optional<SourcedValue>& operator[](Limit limit) { return limits[static_cast<std::size_t>(limit)]; }
};

// The built-in processes: fdm, sla, sls, metal. Each has wall, gap and radii.
std::span<const Process> processes();

// The built-in process of this name, or nullptr.
const Process* find_process(std::string_view name);

// What is packed with when nothing else is said: the limits of `fdm`, for a 0.4 mm nozzle.
//   wall 1.2 mm: three extrusion lines; gap 0.9 mm: two extrusion lines, the least that separates two voids;
//   min_radius 0.62 mm: 1 mm3, below which slicers drop shells; max_radius 25 mm: what pays at 15 % infill
//   (docs/economics.md) still fits. Larger voids than the bridge allows get roofs.
inline constexpr PackingLimits kDefaultLimits{.wall = 1.2, .gap = 0.9, .min_radius = 0.62, .max_radius = 25};

}  // namespace aerate
