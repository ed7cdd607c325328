#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace aerate {

// Words as in a sentence: "a", "a or b", "a, b or c" where `last` is "or".
std::string listed(std::span<const std::string> words, std::string_view last);

// "1 hole", "2 holes".
std::string counted(std::size_t count, std::string_view one, std::string_view many);

}  // namespace aerate
