#pragma once

#include <string>

#include "pipeline/report.h"

namespace aerate::cli {

// Reports for people, as lines that end in a newline. Lengths in mm, volumes in mm3.
std::string to_text(const HollowReport& report);
std::string to_text(const PackReport& report);
std::string to_text(const InspectReport& report);

}  // namespace aerate::cli
