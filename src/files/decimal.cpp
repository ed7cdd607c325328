#include "files/decimal.h"

#include <charconv>
#include <cmath>

namespace aerate {

// Nine significant digits give fp32 back to a reader that rounds once. Readers that add up the parts of a
// number in fp32, as assimp's, need a decimal that is nearer to it than that, and no exponent. (fmt's own
// fixed notation gives the same digits in twice the time.)
std::string_view to_digits(Decimal decimal, DecimalDigits& digits) {
  constexpr int kSignificantDigits = 11;
  constexpr double kLog10Of2 = 0.301029995663981;
  if (decimal.value == 0) return "0";
  const int exponent = static_cast<int>(std::floor(std::ilogb(decimal.value) * kLog10Of2));
  const int decimals = std::max(1, kSignificantDigits - 1 - exponent);
  const char* end = std::to_chars(digits.data(), digits.data() + digits.size(),
                                  static_cast<double>(decimal.value), std::chars_format::fixed, decimals)
                        .ptr;
  while (end[-1] == '0') --end;
  if (end[-1] == '.') --end;
  return {digits.data(), end};
}

}  // namespace aerate
