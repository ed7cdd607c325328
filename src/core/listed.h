#pragma once

#include <span>
#include <string>
#include <string_view>

namespace aerate {

// Words as in a sentence: "a", "a or b", "a, b or c" where `last` is "or".
std::string listed(std::span<const std::string> words, std::string_view last);

}  // namespace aerate
