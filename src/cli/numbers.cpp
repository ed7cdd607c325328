#include "cli/numbers.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace aerate::cli {

std::optional<double> parse_number(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = error == std::errc() && end == text.data() + text.size() && std::isfinite(number);
  return is_number ? std::optional(number) : std::nullopt;
}

std::optional<Vec3d> parse_point(std::string_view text) {
  const auto n = parse_numbers<3>(text);
  if (!n) return std::nullopt;
  return Vec3d{(*n)[0], (*n)[1], (*n)[2]};
}

std::optional<Box3d> parse_box(std::string_view text) {
  const auto n = parse_numbers<6>(text);
  if (!n) return std::nullopt;
  const Vec3d a{(*n)[0], (*n)[1], (*n)[2]}, b{(*n)[3], (*n)[4], (*n)[5]};
  return Box3d{min_of(a, b), max_of(a, b)};
}

std::optional<Vec3d> parse_direction(std::string_view text) {
  constexpr std::pair<std::string_view, Vec3d> kAxes[] = {{"+x", {1, 0, 0}}, {"-x", {-1, 0, 0}},
                                                          {"+y", {0, 1, 0}}, {"-y", {0, -1, 0}},
                                                          {"+z", {0, 0, 1}}, {"-z", {0, 0, -1}}};
  for (const auto& [name, axis] : kAxes)
    if (text == name) return axis;
  const auto direction = parse_point(text);
  const double extent = direction ? length(*direction) : 0;
  if (!(extent > 0) || !std::isfinite(extent)) return std::nullopt;
  return *direction * (1 / extent);
}

CLI::Validator number_between(std::optional<double> least, double most, const std::string& unit) {
  const std::string suffix = unit.empty() ? "" : " " + unit;
  const auto check = [least, most, suffix](const std::string& text) -> std::string {
    const std::optional<double> parsed = parse_number(text);
    if (!parsed) return fmt::format("'{}' is not a number", text);
    const double number = *parsed;
    if (number > most) return fmt::format("{}{} is too much (at most {}{})", text, suffix, most, suffix);
    if (least && number < *least)
      return fmt::format("{}{} is too little (at least {}{})", text, suffix, *least, suffix);
    if (!least && number <= 0) return fmt::format("{}{} is too little (more than 0{})", text, suffix, suffix);
    return {};
  };
  return CLI::Validator(check, "");
}

CLI::Validator whole_number_between(double least, double most, const std::string& unit) {
  const CLI::Validator in_range = number_between(least, most, unit);
  const auto check = [in_range](const std::string& text) -> std::string {
    std::string fault = in_range(text);
    if (!fault.empty()) return fault;
    const double number = parse_number(text).value();
    return number == std::floor(number) ? std::string() : fmt::format("'{}' is not a whole number", text);
  };
  return CLI::Validator(check, "");
}

}  // namespace aerate::cli
