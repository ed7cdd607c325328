#include "core/printable.h"

#include <cstdint>
#include <fmt/format.h>
#include <iterator>

namespace aerate {
namespace {

struct Shape {
  std::size_t length;
  std::uint32_t least;       // what needs as many bytes
  unsigned char mask, lead;  // of the first byte
};
constexpr Shape kShapes[] = {
    {1, 0, 0x80, 0x00}, {2, 0x80, 0xe0, 0xc0}, {3, 0x800, 0xf0, 0xe0}, {4, 0x10000, 0xf8, 0xf0}};

// Of the character at the front of `text` in UTF-8; 0 if there is none that may be shown.
std::size_t shown_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (const Shape& shape : kShapes) {
    if ((byte(0) & shape.mask) != shape.lead) continue;
    if (text.size() < shape.length) return 0;
    std::uint32_t character = byte(0) & static_cast<unsigned char>(~shape.mask);
    for (std::size_t i = 1; i < shape.length; ++i) {
      if ((byte(i) & 0xc0) != 0x80) return 0;
      character = character << 6 | (byte(i) & 0x3f);
    }
    const bool is_control = character < 0x20 || (character >= 0x7f && character < 0xa0);
    const bool is_surrogate = character >= 0xd800 && character < 0xe000;
    return character < shape.least || character > 0x10ffff || is_surrogate || is_control ? 0 : shape.length;
  }
  return 0;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = shown_length(text);
    if (length == 0) {
      fmt::format_to(std::back_inserter(shown), "\\x{:02x}", static_cast<unsigned char>(text.front()));
    }
    shown += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return shown;
}

}  // namespace aerate
