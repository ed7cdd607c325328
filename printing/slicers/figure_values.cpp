#include "printing/slicers/figure_values.h"

#include <algorithm>
#include <array>
#include <utility>

#include "printing/slicers/text_file.h"

namespace aerate {

std::optional<double> sum_of(std::string_view text) {
  std::optional<double> sum = take_number(text);
  while (sum && trimmed(text).starts_with(',')) {
    text = trimmed(text).substr(1);
    const std::optional<double> next = take_number(text);
    if (!next) return std::nullopt;
    sum = *sum + *next;
  }
  return sum;
}

std::optional<double> seconds_of(std::string_view text) {
  double seconds = 0;
  bool found = false;
  while (const std::optional<double> number = take_number(text)) {
    constexpr std::array<std::pair<char, double>, 4> kUnits{{{'d', 86400}, {'h', 3600}, {'m', 60}, {'s', 1}}};
    const auto unit = std::find_if(kUnits.begin(), kUnits.end(),
                                   [&](const auto& each) { return text.starts_with(each.first); });
    if (unit == kUnits.end()) return std::nullopt;
    seconds += *number * unit->second;
    found = true;
    text.remove_prefix(1);
  }
  return found ? std::optional(seconds) : std::nullopt;
}

}  // namespace aerate
