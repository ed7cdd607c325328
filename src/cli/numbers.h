#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <cstddef>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <string_view>

#include "kernels/vec.h"

namespace aerate::cli {

// The finite number that is the whole text, if it is one.
std::optional<double> parse_number(std::string_view text);

// Just so many numbers with commas between them.
template <std::size_t kCount>
std::optional<std::array<double, kCount>> parse_numbers(std::string_view text) {
  std::array<double, kCount> numbers{};
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::size_t comma = text.find(',');
    const bool is_last = i + 1 == kCount;
    if ((comma == std::string_view::npos) != is_last) return std::nullopt;
    const auto number = parse_number(text.substr(0, comma));
    if (!number) return std::nullopt;
    numbers[i] = *number;
    text.remove_prefix(is_last ? text.size() : comma + 1);
  }
  return numbers;
}

// "x,y,z"
std::optional<Vec3d> parse_point(std::string_view text);

// Two corners, "x0,y0,z0,x1,y1,z1", in any order.
std::optional<Box3d> parse_box(std::string_view text);

// "+x", "-x", .., "-z" or "x,y,z" as a unit vector; nothing for other texts and for 0,0,0.
std::optional<Vec3d> parse_direction(std::string_view text);

// Accepts what a function makes something of; `fault` says of other texts what they are not.
template <typename Parse>
CLI::Validator parsed_by(Parse parse, const std::string& fault) {
  const auto check = [parse, fault](const std::string& text) {
    return parse(text) ? std::string() : fmt::format("'{}' {}", text, fault);
  };
  return CLI::Validator(check, "");
}

// Accepts a number in [least, most], or in (0, most] with `least` absent; `unit` is for the message.
CLI::Validator number_between(std::optional<double> least, double most, const std::string& unit);

// The same without fractions.
CLI::Validator whole_number_between(double least, double most, const std::string& unit);

}  // namespace aerate::cli
