#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "packing/air/inspect_drainage.h"
#include "pipeline/own_cavities.h"
#include "pipeline/prepare.h"
#include "pipeline/process_choice.h"

namespace aerate {

// What the layers of a print close in while it grows, in processes that limit it.
struct PrintedCups {
  Build build = Build::standing;
  LimitValue limit;              // mm2
  std::optional<AirCup> widest;  // absent: there are none
  std::size_t over_limit = 0;
  std::vector<AirCup> worst = {};  // the widest, and all others over the limit
};

// nullopt in a process that limits no cups.
std::optional<PrintedCups> printed_cups(const std::vector<AirCup>& cups, const Process& process, Build build);

// Where suction is more than the process allows: where, and where a hole would end it.
void warn_of_suction(const PrintedCups& cups, const Process& process, Monitor& monitor);

struct DrainageInquiry {
  Process process;
  PrintDirection direction;
  Build build = Build::standing;
  std::optional<double> widest_hole;  // mm; twice the process's escape hole if not given
};

// How a model drains that is as it is.
struct DrainageFindings {
  DrainageInquiry inquiry;
  double widest_hole = 0;                // that was taken for one, mm
  std::optional<InspectedDrainage> air;  // absent: it bounds no solid
  OwnCavities sealed;
  std::optional<PrintedCups> cups;
  bool drains = false;
  std::string verdict;  // one line
};

// Throws UsageError for a process without escape holes.
DrainageFindings inspect_drainage_of(const PreparedModel& read, const DrainageInquiry& inquiry,
                                     Monitor& monitor);

// As printed, and turned over after that, mm3.
inline double as_printed(const TrappedPools& pools, Build build) {
  return build == Build::hanging ? pools.upside_down : pools.upright;
}
inline double turned_over(const TrappedPools& pools, Build build) {
  return build == Build::hanging ? pools.upright : pools.upside_down;
}

}  // namespace aerate
