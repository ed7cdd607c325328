#pragma once

#include <optional>
#include <string>

#include "core/monitor.h"
#include "pipeline/prepare.h"
#include "pipeline/process_choice.h"
#include "supports/overhangs.h"

namespace aerate {

// What of a model cannot be printed without supports is asked.
struct OverhangInquiry {
  Process process;
  PrintDirection direction;
  Limits given = {};  // the overhang angle and the bridge, where they are not the process's
};

struct OverhangFindings {
  OverhangInquiry inquiry;
  std::optional<SupportRules> rules;   // absent: a process that needs no supports
  std::optional<Overhangs> overhangs;  // absent too where the model bounds no solid
  std::string verdict;                 // one line
};

// Throws InterruptedError.
OverhangFindings find_overhangs_of(const PreparedModel& read, const OverhangInquiry& inquiry,
                                   Monitor& monitor);

}  // namespace aerate
