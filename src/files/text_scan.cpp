#include "files/text_scan.h"

namespace aerate {
namespace {

std::size_t take_digits(std::string_view& text) {
  std::size_t digits = 0;
  while (digits < text.size() && text[digits] >= '0' && text[digits] <= '9') ++digits;
  text.remove_prefix(digits);
  return digits;
}

bool take_one_of(std::string_view characters, std::string_view& text) {
  if (text.empty() || characters.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

bool is_word(std::string_view token, std::string_view lower_case_word) {
  return std::equal(token.begin(), token.end(), lower_case_word.begin(), lower_case_word.end(),
                    [](char a, char b) { return to_lower_ascii(a) == b; });
}

}  // namespace

bool is_number(std::string_view token) {
  constexpr std::size_t kMostWholeDigits = 19, kMostExponentDigits = 4;
  take_one_of("+-", token);
  if (is_word(token, "nan") || is_word(token, "inf") || is_word(token, "infinity")) return true;
  const std::size_t whole = take_digits(token);
  const std::size_t decimals = take_one_of(".", token) ? take_digits(token) : 0;
  if (whole + decimals == 0 || whole > kMostWholeDigits) return false;
  if (!take_one_of("eE", token)) return token.empty();
  take_one_of("+-", token);
  const std::size_t exponent = take_digits(token);
  return exponent > 0 && exponent <= kMostExponentDigits && token.empty();
}

}  // namespace aerate
