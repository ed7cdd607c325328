#include "printing/slicers/text_file.h"

#include <fmt/format.h>
#include <fstream>
#include <sstream>
#include <utility>

#include "core/error.h"

namespace aerate {

std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  // Of an empty file nothing can be taken, which counts as a failure.
  if (stream.peek() != std::ifstream::traits_type::eof()) text << stream.rdbuf();
  if (!stream.is_open() || stream.bad() || text.fail()) throw InputError(path.string() + ": cannot be read");
  return std::move(text).str();
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const auto first = static_cast<unsigned char>(text.front());
    const std::size_t bytes = first < 0x80       ? 1
                              : first >> 5 == 6  ? 2
                              : first >> 4 == 14 ? 3
                              : first >> 3 == 30 ? 4
                                                 : 0;
    if (bytes == 0 || text.size() < bytes) return false;
    for (const char c : text.substr(1, bytes - 1)) {
      if (static_cast<unsigned char>(c) >> 6 != 2) return false;
    }
    text.remove_prefix(bytes);
  }
  return true;
}

std::string on_one_line(std::string_view text) {
  constexpr std::size_t kLongest = 1000;
  constexpr unsigned char kFirstPrinted = 0x20, kDelete = 0x7F;
  std::string line;
  for (const char c : text.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < kFirstPrinted || byte == kDelete) {
      line += fmt::format("\\x{:02X}", byte);
    } else {
      line += c;
    }
  }
  return text.size() > kLongest ? line + "..." : line;
}

}  // namespace aerate
