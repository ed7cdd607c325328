#pragma once

#include <string>

#include "pipeline/hook.h"
#include "pipeline/slice_model.h"

namespace aerate::cli {

// Reports of `slice` and `hook`: the slicer's figures for every form side by side. As report_text.h and
// report_json.h.
std::string to_text(const SliceReport& report);
std::string to_text(const HookReport& report);
std::string to_json(const SliceReport& report);
std::string to_json(const HookReport& report);

}  // namespace aerate::cli
