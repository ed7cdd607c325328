#include "pipeline/own_cavities.h"

#include <fmt/format.h>

namespace aerate {

OwnCavities cavities_of(const Inspection& inspection) {
  constexpr double kLeast = 0.01;  // mm3
  OwnCavities cavities;
  for (const Shell& shell : inspection.shells) {
    if (!(shell.volume < -kLeast)) continue;
    ++cavities.count;
    cavities.volume -= shell.volume;
    if (-shell.volume <= cavities.largest) continue;
    cavities.largest = -shell.volume;
    cavities.place = (to_double(shell.box.lower) + to_double(shell.box.upper)) * 0.5;
  }
  return cavities;
}

void warn_of_cavities(const Inspection& inspection, const Process& process, Monitor& monitor) {
  if (process.drainage == Drainage::not_needed) return;
  const OwnCavities cavities = cavities_of(inspection);
  if (cavities.count == 0) return;
  const bool is_one = cavities.count == 1;
  monitor.notice(fmt::format(
      "the model itself has {} sealed {} ({:.1f} mm3, {}near ({:.2f}, {:.2f}, {:.2f}) mm), which stay{} "
      "sealed: a print by {} keeps its liquid or powder in {}; open {} in a mesh editor, or take {} inner "
      "{} away, so that voids are packed there instead",
      cavities.count, is_one ? "cavity" : "cavities", cavities.volume, is_one ? "" : "the largest ",
      cavities.place.x, cavities.place.y, cavities.place.z, is_one ? "s" : "", process.name,
      is_one ? "it" : "them", is_one ? "it" : "them", is_one ? "its" : "their",
      is_one ? "surface" : "surfaces"));
}

}  // namespace aerate
