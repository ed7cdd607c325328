#pragma once

#include <string>
#include <string_view>

namespace aerate {

// As zlib packs it (RFC 1950).
std::string deflated(std::string_view bytes);

// RFC 4648, with padding, on one line.
std::string base64(std::string_view bytes);

}  // namespace aerate
