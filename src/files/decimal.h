#pragma once

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <string_view>

namespace aerate {

// A coordinate as the text formats have it, for fmt: reads back to the same fp32, without an exponent,
// whatever the locale.
struct Decimal {
  float value;
};

using DecimalDigits = std::array<char, 80>;  // 39 before the point, or 57 after it, at most

std::string_view to_digits(Decimal decimal, DecimalDigits& digits);

}  // namespace aerate

template <>
struct fmt::formatter<aerate::Decimal> {
  constexpr auto parse(format_parse_context& context) { return context.begin(); }

  template <typename Context>
  auto format(aerate::Decimal decimal, Context& context) const {
    aerate::DecimalDigits digits;
    const std::string_view text = aerate::to_digits(decimal, digits);
    return std::copy(text.begin(), text.end(), context.out());
  }
};
