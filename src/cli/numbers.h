#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "kernels/vec.h"

namespace aerate::cli {

// The finite number that is the whole text, if it is one.
std::optional<double> parse_number(std::string_view text);

// "x,y,z"
std::optional<Vec3d> parse_point(std::string_view text);

// "+x", "-x", .., "-z" or "x,y,z" as a unit vector; nothing for other texts and for 0,0,0.
std::optional<Vec3d> parse_direction(std::string_view text);

// Accepts a number in [least, most], or in (0, most] with `least` absent; `unit` is for the message.
CLI::Validator number_between(std::optional<double> least, double most, const std::string& unit);

// The same without fractions.
CLI::Validator whole_number_between(double least, double most, const std::string& unit);

// No length of a print is beyond this, mm.
inline constexpr double kLongest = 1e5;

}  // namespace aerate::cli
