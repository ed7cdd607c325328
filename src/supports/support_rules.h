#pragma once

#include <optional>
#include <string>

#include "printing/processes.h"

namespace aerate {

// What a process prints without supports, and what its supports have to be.
struct SupportRules {
  double degrees = 45;  // from the vertical: what leans out further needs supports...
  double reach = 2.5;   // ...beyond this distance from what holds it, mm; half the bridge, where there is one
  std::string degrees_source;
  std::string reach_source;
  double layer = 0.2;       // usual height of a layer, mm
  bool is_filament = true;  // else supports are attached by tips, and drained
};

// Nothing for a process whose powder carries the part: one without an overhang angle.
//   given: an overhang angle and a bridge that go before the process's
std::optional<SupportRules> support_rules(const Process& process, const Limits& given = {});

// Throws UsageError for such a process, naming those that have supports.
SupportRules require_support_rules(const Process& process, const Limits& given = {});

}  // namespace aerate
