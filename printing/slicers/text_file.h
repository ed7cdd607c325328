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
