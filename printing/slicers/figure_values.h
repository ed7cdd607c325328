#pragma once

#include <optional>
#include <string_view>

// What stands behind the labels of figures in G-code.
namespace aerate {

// "1.5, 2.25" of several extruders, added up.
std::optional<double> sum_of(std::string_view text);

// "1d 2h 3m 4s", and whatever stands behind it.
std::optional<double> seconds_of(std::string_view text);

}  // namespace aerate
