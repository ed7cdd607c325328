#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

// What slicers read and write is text: G-code, settings, what they print.
namespace aerate {

// All bytes of a file. Throws InputError if it cannot be read, or is no regular file.
std::string read_text(const std::filesystem::path& path);

// Text from outside as it may stand in a comment of G-code or in a message: nothing in it ends a line or
// commands a terminal. Control characters become "\\x0A" and the like; what is too long is cut off. All other bytes stay
// as they are, whatever their encoding: slicers name objects in it by these bytes. What is shown goes through
// `printable` besides, which takes nothing that is no UTF-8.
std::string on_one_line(std::string_view text);

bool is_utf8(std::string_view text);

// Calls f(line) for each line, without its line end; f returns false to stop.
template <typename F>
void for_each_line(std::string_view text, const F& f) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!f(line)) return;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

inline std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

// Without what slicers take for blanks round it: tabs, line ends and the like among them.
inline std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n\v\f";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

// The number at the front of `text`, which is taken off it.
inline std::optional<double> take_number(std::string_view& text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

inline std::optional<double> number_at_front(std::string_view text) {
  return take_number(text);
}

}  // namespace aerate
