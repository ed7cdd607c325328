#include "files/decimal.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace aerate {

void append_index(std::string& out, std::uint64_t index) {
  std::array<char, 20> digits{};
  out.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), index).ptr);
}

// Nine significant digits give fp32 back to a reader that rounds once. Readers that add up the parts of a
// number in fp32, as assimp's, need a decimal that is nearer to it than that, and no exponent.
void append_coordinate(std::string& out, float coordinate) {
  constexpr int kSignificantDigits = 11;
  constexpr double kLog10Of2 = 0.301029995663981;
  if (coordinate == 0) {
    out += '0';
    return;
  }
  const int exponent = static_cast<int>(std::floor(std::ilogb(coordinate) * kLog10Of2));
  const int decimals = std::max(1, kSignificantDigits - 1 - exponent);
  std::array<char, 80> digits{};  // 39 before the point, or 57 after it, at most
  char* end = std::to_chars(digits.data(), digits.data() + digits.size(), static_cast<double>(coordinate),
                            std::chars_format::fixed, decimals)
                  .ptr;
  while (end[-1] == '0') --end;
  if (end[-1] == '.') --end;
  out.append(digits.data(), end);
}

}  // namespace aerate
