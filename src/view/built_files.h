#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace aerate {

// What was built from web/ and put into the program, by its name ("view.html", without its data; "studio.js"), or nothing where
// the program was built without it.
std::optional<std::string_view> built_file(std::string_view name);

// Why there is none of this name: what the build was missing.
std::string why_no_built_file(std::string_view name);

}  // namespace aerate
