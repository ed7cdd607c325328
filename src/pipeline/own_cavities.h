#pragma once

#include <cstddef>

#include "core/monitor.h"
#include "mesh/inspect.h"
#include "pipeline/process_choice.h"

namespace aerate {

// Inward shells: cavities that a model has itself, and that nothing leads out of. Those of less than a hundredth of a
// cubic millimetre are folds of a scan.
struct OwnCavities {
  std::size_t count = 0;
  double volume = 0;  // of all, mm3
  double largest = 0;
  Vec3d place{0, 0, 0};  // the middle of the largest one's box
};
OwnCavities cavities_of(const Inspection& inspection);

// If there are any, and the process leaves its material in them: how many, where, and what to do.
void warn_of_cavities(const Inspection& inspection, const Process& process, Monitor& monitor);

}  // namespace aerate
