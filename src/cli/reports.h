#pragma once

#include <string>

#include "pipeline/hook.h"
#include "pipeline/report.h"
#include "pipeline/slice_model.h"
#include "pipeline/slice_supports.h"
#include "pipeline/support.h"

namespace aerate::cli {

// Reports for people, as lines that end in a newline. Lengths in mm, volumes in mm3.
std::string to_text(const HollowReport& report);
std::string to_text(const PackReport& report);
std::string to_text(const InspectReport& report);
std::string to_text(const SupportReport& report);
std::string to_text(const SliceReport& report);
std::string to_text(const SliceSupportsReport& report);
std::string to_text(const HookReport& report);

// Reports for programs: one JSON object and a newline, in UTF-8; the fields are described in docs/report.md.
std::string to_json(const HollowReport& report);
std::string to_json(const PackReport& report);
std::string to_json(const InspectReport& report);
std::string to_json(const SupportReport& report);
std::string to_json(const SliceReport& report);
std::string to_json(const SliceSupportsReport& report);
std::string to_json(const HookReport& report);

}  // namespace aerate::cli
