#pragma once

#include <optional>
#include <string_view>

namespace aerate {

// The built page without its data (web/), or nothing where the program was built without it.
std::optional<std::string_view> page_template();

// Why there is none: what the build was missing.
std::string_view why_no_page();

}  // namespace aerate
