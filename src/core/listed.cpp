#include "core/listed.h"

#include <fmt/ranges.h>

namespace aerate {

std::string listed(std::span<const std::string> words, std::string_view last) {
  if (words.size() < 2) return words.empty() ? std::string() : words.front();
  return fmt::format("{} {} {}", fmt::join(words.first(words.size() - 1), ", "), last, words.back());
}

std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

}  // namespace aerate
