#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "files/input_file.h"

// Reading text formats piece by piece.
namespace aerate {

// Some programs put it before text.
inline constexpr std::string_view kUtf8Mark = "\xef\xbb\xbf";

inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r';
}

// Locale-free.
inline char to_lower_ascii(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

// A file name's ending with its dot, in lower case; empty if it has none.
inline std::string ending_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), to_lower_ascii);
  return ending;
}

// What begins after the mark of UTF-8, if a text has one.
inline std::size_t start_of_text(std::string_view text) {
  return text.starts_with(kUtf8Mark) ? kUtf8Mark.size() : 0;
}

// Takes the next run of non-blank characters off the front of `line`; empty at its end.
inline std::string_view take_token(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && is_blank(line[begin])) ++begin;
  std::size_t end = begin;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view token = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return token;
}

// Where a comment begins in a line that may have one. "1.#QNAN" is how some compilers write what is no number.
inline std::size_t find_comment(std::string_view line) {
  std::size_t mark = line.find('#');
  while (mark != std::string_view::npos && mark > 0 && line[mark - 1] == '.') mark = line.find('#', mark + 1);
  return mark;
}

// The whole of `token` as a decimal number, whatever the locale.
template <typename Number>
std::optional<Number> parse_number(std::string_view token) {
  Number value = 0;
  const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (error != std::errc() || end != token.data() + token.size()) return std::nullopt;
  return value;
}

inline std::optional<std::int64_t> parse_integer(std::string_view token) {
  return parse_number<std::int64_t>(token);
}

// Whether the whole of `token` is a decimal number, NaN and infinity among them, that assimp reads as one: it
// takes the front of "20mm" or "20,5" for all of it, and wraps around when there are too many digits.
bool is_number(std::string_view token);

// Lines of a text file, ended by LF, CR or CR LF, numbered from 1.
class LineReader {
 public:
  explicit LineReader(const InputFile& file, std::size_t start = 0)
      : file_(file), rest_(file.text().substr(start)) {
    const std::string_view before = file.text().substr(0, start);
    number_ = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  }

  std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    ++number_;
    const std::size_t end = rest_.find_first_of("\r\n");
    const std::string_view line = rest_.substr(0, end);
    if (end == std::string_view::npos) {
      rest_ = {};
    } else {
      const bool crlf = rest_.substr(end, 2) == "\r\n";
      rest_.remove_prefix(end + (crlf ? 2 : 1));
    }
    return line;
  }

  std::size_t number() const { return number_; }  // of the line that `next` gave last

  // Throws InputError that names the line.
  template <typename... Arguments>
  [[noreturn]] void fail(fmt::format_string<Arguments...> what, Arguments&&... arguments) const {
    fail_to_read(file_, "line {}: {}", number_, fmt::format(what, std::forward<Arguments>(arguments)...));
  }

 private:
  const InputFile& file_;
  std::string_view rest_;
  std::size_t number_ = 0;
};

}  // namespace aerate
