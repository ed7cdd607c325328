#include "studio/names.h"

#include <cstddef>
#include <fmt/format.h>

#include "core/printable.h"
#include "files/formats.h"

namespace aerate::studio {
namespace {

bool is_plain(unsigned char byte) {
  return (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z') ||
         byte == '.' || byte == '-' || byte == '_';
}

// Bytes of a sequence of UTF-8 at the front of a text, 0 for what is none.
std::size_t length_of_character(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t length = first < 0x80       ? 1
                             : first >> 5 == 6  ? 2
                             : first >> 4 == 14 ? 3
                             : first >> 3 == 30 ? 4
                                                : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) return 0;
  return length;
}

// Whole characters, as many as there is room for; what is no character becomes '_'.
std::string characters_of(std::string_view text, std::size_t most) {
  std::string characters;
  while (!text.empty() && characters.size() < most) {
    const std::size_t length = length_of_character(text);
    const bool is_control = length == 1 && (text[0] < ' ' || text[0] == 0x7f);
    if (length == 0 || is_control) {
      characters += '_';
    } else {
      characters += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return characters;
}

}  // namespace

std::string shown_name(std::string_view sent) {
  constexpr std::size_t kMost = 120;
  constexpr std::size_t kEnding = 16;  // of these at the end
  if (const std::size_t slash = sent.find_last_of("/\\"); slash != std::string_view::npos)
    sent.remove_prefix(slash + 1);
  if (sent.size() <= kMost) return characters_of(sent, kMost);
  const std::size_t dot = sent.rfind('.');
  const std::string_view ending =
      dot == std::string_view::npos || sent.size() - dot > kEnding ? std::string_view() : sent.substr(dot);
  return characters_of(sent, kMost - kEnding) + characters_of(ending, kEnding);
}

std::string ending_of_model(const std::string& name) {
  return format_to_read(name).ending;
}

std::string name_of_result(const std::string& model_name, std::string_view ending) {
  const std::size_t dot = model_name.rfind('.');
  const std::string stem = model_name.substr(0, dot);
  return fmt::format("{}-hollow{}", stem.empty() ? "model" : stem, ending);
}

std::string attachment_called(const std::string& name) {
  std::string plain, coded;
  for (const char character : name) {
    const auto byte = static_cast<unsigned char>(character);
    plain += is_plain(byte) ? character : '_';
    coded += is_plain(byte) ? std::string(1, character) : fmt::format("%{:02X}", byte);
  }
  return fmt::format("attachment; filename=\"{}\"; filename*=UTF-8''{}", plain, coded);
}

std::string ShownPaths::in(std::string text) const {
  for (const auto& [path, name] : names_)
    for (std::size_t at = text.find(path); at != std::string::npos; at = text.find(path, at + name.size()))
      text.replace(at, path.size(), name);
  return text;
}

}  // namespace aerate::studio
