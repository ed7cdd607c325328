#pragma once

#include <string>

#include "pipeline/report.h"

namespace aerate::cli {

// Version of the JSON schemas of docs/report.md: grows when a field changes its meaning or goes away, not
// when one is added.
inline constexpr int kReportSchemaVersion = 1;

// Reports for programs: one JSON object and a newline, in UTF-8; the fields are described in docs/report.md.
std::string to_json(const HollowReport& report);
std::string to_json(const PackReport& report);
std::string to_json(const InspectReport& report);

}  // namespace aerate::cli
