#pragma once

#include <cstdint>
#include <vector>

#include "supports/ridges.h"
#include "supports/support_rules.h"
#include "supports/undersides.h"

namespace aerate {

// Where supports touch what they hold.
enum class ToothKind { ridge, cone };

struct TeethPlan {
  ToothKind kind = ToothKind::ridge;
  double reach = 0;                 // of the process, mm
  std::vector<std::uint32_t> held;  // spans with a tooth under their ceilings, ascending
  std::vector<RidgeRun> runs;       // these as ridges, if that is what they are
  std::vector<std::uint32_t>
      carried;  // spans under whose ceilings there is a body, teeth among them; ascending
};

// Teeth so that no ceiling is farther from what holds it than the process's reach, and one under each place that begins in the
// air. Ridges: in each overhang parallel ones no farther apart than twice the reach, and under free edges (supports/ridges.h); cones, and
// what ridges miss: always where it is farthest.
TeethPlan plan_teeth(const Undersides& undersides, const SupportRules& rules, ToothKind kind);

}  // namespace aerate
