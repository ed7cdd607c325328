#pragma once

#include <cstdint>
#include <string>

namespace aerate {

// Decimal numbers of the text formats, without exponents and whatever the locale.
void append_index(std::string& out, std::uint64_t index);
// Reads back to the same fp32.
void append_coordinate(std::string& out, float coordinate);

}  // namespace aerate
