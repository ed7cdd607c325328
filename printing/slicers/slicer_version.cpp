#include "printing/slicers/slicer_version.h"

#include <array>
#include <charconv>
#include <cstddef>
#include <fmt/format.h>

namespace aerate {

std::string to_text(const SlicerVersion& version) {
  return fmt::format("{}.{}.{}", version.major, version.minor, version.patch);
}

std::optional<SlicerVersion> parse_version(std::string_view text) {
  std::array<int, 3> numbers{};
  std::size_t count = 0;
  const char *at = text.data(), *const end = text.data() + text.size();
  while (count < numbers.size()) {
    const auto [next, error] = std::from_chars(at, end, numbers[count]);
    if (error != std::errc() || numbers[count] < 0) break;
    ++count;
    at = next;
    if (at == end || *at != '.') break;
    ++at;
  }
  if (count < 2) return std::nullopt;
  return SlicerVersion{numbers[0], numbers[1], numbers[2]};
}

std::optional<SlicerVersion> version_of(std::string_view program, std::string_view text) {
  constexpr std::size_t kHead = 400;  // bytes: where slicers name themselves
  text = text.substr(0, kHead);
  for (std::size_t at = text.find(program); at != std::string_view::npos; at = text.find(program, at + 1)) {
    const std::string_view rest = text.substr(at + program.size());
    if (!rest.starts_with(' ') && !rest.starts_with('-')) continue;
    if (const auto version = parse_version(rest.substr(1))) return version;
  }
  return std::nullopt;
}

}  // namespace aerate
