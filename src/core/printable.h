#pragma once

#include <string>
#include <string_view>

namespace aerate {

// Text from outside, such as a file's name, as it may be shown on a terminal: control characters, which would
// move its cursor or answer for the user, and bytes that are no UTF-8 become "\x1b".
std::string printable(std::string_view text);

}  // namespace aerate
