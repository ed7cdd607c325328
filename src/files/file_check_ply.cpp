#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "files/file_check.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string_view name;
  PlyType type;
  std::optional<PlyType> count_type;  // of a list
};

struct Element {
  std::string_view name;
  std::int64_t count;
  std::vector<Property> properties;
};

enum class Encoding { ascii, little_endian, big_endian };

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      return 4;
    case PlyType::float64:
      return 8;
  }
  return 0;
}

std::optional<PlyType> parse_type(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> kNames{{
      {"char", PlyType::int8},
      {"int8", PlyType::int8},
      {"uchar", PlyType::uint8},
      {"uint8", PlyType::uint8},
      {"short", PlyType::int16},
      {"int16", PlyType::int16},
      {"ushort", PlyType::uint16},
      {"uint16", PlyType::uint16},
      {"int", PlyType::int32},
      {"int32", PlyType::int32},
      {"uint", PlyType::uint32},
      {"uint32", PlyType::uint32},
      {"float", PlyType::float32},
      {"float32", PlyType::float32},
      {"double", PlyType::float64},
      {"float64", PlyType::float64},
  }};
  for (const auto& [text, type] : kNames) {
    if (text == name) return type;
  }
  return std::nullopt;
}

template <typename T>
std::int64_t read_integer(const char* bytes, Encoding encoding) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), bytes, raw.size());
  if (encoding == Encoding::big_endian) std::reverse(raw.begin(), raw.end());
  return static_cast<std::int64_t>(std::bit_cast<T>(raw));
}

std::optional<std::int64_t> read_integer(const char* bytes, PlyType type, Encoding encoding) {
  switch (type) {
    case PlyType::int8:
      return read_integer<std::int8_t>(bytes, encoding);
    case PlyType::uint8:
      return read_integer<std::uint8_t>(bytes, encoding);
    case PlyType::int16:
      return read_integer<std::int16_t>(bytes, encoding);
    case PlyType::uint16:
      return read_integer<std::uint16_t>(bytes, encoding);
    case PlyType::int32:
      return read_integer<std::int32_t>(bytes, encoding);
    case PlyType::uint32:
      return read_integer<std::uint32_t>(bytes, encoding);
    case PlyType::float32:
    case PlyType::float64:
      break;
  }
  return std::nullopt;
}

bool is_vertex_list(const Element& element, const Property& property) {
  return element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index");
}

class PlyCheck {
 public:
  PlyCheck(const FileBytes& bytes, const std::string& name) : text_(bytes.text()), name_(name) {}

  FileFacts run() {
    read_header();
    const Element* const vertex = find("vertex");
    const Element* const face = find("face");
    if (vertex == nullptr || vertex->count == 0) fail("no vertices");
    if (face == nullptr || face->count == 0) fail(fmt::format("{} vertices but no faces", vertex->count));
    for (const std::string_view axis : {"x", "y", "z"}) {
      if (std::none_of(vertex->properties.begin(), vertex->properties.end(),
                       [&](const Property& p) { return p.name == axis && !p.count_type; })) {
        fail(fmt::format("its vertices have no coordinate {}", axis));
      }
    }
    if (std::none_of(face->properties.begin(), face->properties.end(),
                     [&](const Property& p) { return is_vertex_list(*face, p) && p.count_type; })) {
      fail("its faces have no list 'vertex_indices'");
    }
    vertices_ = vertex->count;
    LineReader lines(text_.substr(position_));  // of a text file
    for (const Element& element : elements_) {
      if (encoding_ == Encoding::ascii) {
        walk_text(element, lines);
      } else {
        walk_binary(element);
      }
    }
    return {.face_count = static_cast<std::size_t>(face->count),
            .vertex_count = static_cast<std::size_t>(vertices_)};
  }

 private:
  void read_header() {
    if (header_line() != "ply") fail("not a PLY file: its first line is not 'ply'");
    for (std::string_view line = header_line(); line != "end_header"; line = header_line()) {
      const std::string_view keyword = take_token(line);
      if (keyword == "format") {
        read_format(take_token(line));
      } else if (keyword == "element") {
        const std::string_view element = take_token(line);
        const auto count = parse_integer(take_token(line));
        if (!count || *count < 0 || *count > std::numeric_limits<std::uint32_t>::max() / 3) {
          fail(fmt::format("header: the number of elements '{:.20}' is not usable", element));
        }
        elements_.push_back({element, *count, {}});
      } else if (keyword == "property") {
        read_property(line);
      } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
        fail(fmt::format("header: '{:.20}' is no keyword of PLY", keyword));
      }
    }
    if (!encoding_) fail("header: no 'format' line");
  }

  void read_format(std::string_view format) {
    if (format == "ascii") {
      encoding_ = Encoding::ascii;
    } else if (format == "binary_little_endian") {
      encoding_ = Encoding::little_endian;
    } else if (format == "binary_big_endian") {
      encoding_ = Encoding::big_endian;
    } else {
      fail(fmt::format("header: unknown format '{:.40}'", format));
    }
  }

  void read_property(std::string_view line) {
    if (elements_.empty()) fail("header: a property that belongs to no element");
    std::optional<PlyType> count_type;
    std::string_view type_name = take_token(line);
    if (type_name == "list") {
      count_type = parse_type(take_token(line));
      if (!count_type || *count_type == PlyType::float32 || *count_type == PlyType::float64) {
        fail("header: a list without a count of integer type");
      }
      type_name = take_token(line);
    }
    const auto type = parse_type(type_name);
    if (!type) fail(fmt::format("header: unknown type '{:.20}'", type_name));
    elements_.back().properties.push_back({take_token(line), *type, count_type});
  }

  std::string_view header_line() {
    const std::size_t end = text_.find('\n', position_);
    if (end == std::string_view::npos || end - position_ > 4096)
      fail("not a PLY file, or its header is truncated");
    std::string_view line = text_.substr(position_, end - position_);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    position_ = end + 1;
    return line;
  }

  void walk_binary(const Element& element) {
    if (std::none_of(element.properties.begin(), element.properties.end(),
                     [](const Property& p) { return p.count_type.has_value(); })) {
      std::size_t stride = 0;
      for (const Property& property : element.properties) stride += size_of(property.type);
      const auto held =
          stride == 0 ? element.count : static_cast<std::int64_t>((text_.size() - position_) / stride);
      if (held < element.count) fail_truncated(element, held);
      position_ += stride * static_cast<std::size_t>(element.count);
      return;
    }
    for (std::int64_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) walk_binary(element, property, i);
    }
  }

  void walk_binary(const Element& element, const Property& property, std::int64_t i) {
    std::int64_t count = 1;
    if (property.count_type) {
      const char* const at = take_bytes(element, i, size_of(*property.count_type));
      count = read_integer(at, *property.count_type, *encoding_).value_or(-1);
      if (count < 0) fail(fmt::format("{} {}: a list of {} values", element.name, i, count));
    }
    const std::size_t size = size_of(property.type);
    if (static_cast<std::size_t>(count) > text_.size() / size) fail_truncated(element, i);
    const char* const values = take_bytes(element, i, static_cast<std::size_t>(count) * size);
    if (!is_vertex_list(element, property)) return;
    for (std::int64_t corner = 0; corner < count; ++corner) {
      check_index(read_integer(values + static_cast<std::size_t>(corner) * size, property.type, *encoding_),
                  i);
    }
  }

  const char* take_bytes(const Element& element, std::int64_t i, std::size_t count) {
    if (text_.size() - position_ < count) fail_truncated(element, i);
    const char* const bytes = text_.data() + position_;
    position_ += count;
    return bytes;
  }

  void walk_text(const Element& element, LineReader& lines) {
    for (std::int64_t i = 0; i < element.count; ++i) {
      auto line = lines.next();
      if (!line) fail_truncated(element, i);
      for (const Property& property : element.properties) walk_text(element, property, *line, i);
    }
  }

  void walk_text(const Element& element, const Property& property, std::string_view& line, std::int64_t i) {
    std::int64_t count = 1;
    if (property.count_type) {
      const auto listed = parse_integer(take_token(line));
      if (!listed || *listed < 0) fail(fmt::format("{} {}: a list without a count", element.name, i));
      count = *listed;
    }
    for (std::int64_t value = 0; value < count; ++value) {
      const std::string_view token = take_token(line);
      if (token.empty()) {
        fail(
            fmt::format("{} {}: too few values in its line: truncated, or not this format", element.name, i));
      }
      if (is_vertex_list(element, property)) check_index(parse_integer(token), i);
    }
  }

  void check_index(std::optional<std::int64_t> index, std::int64_t face) {
    if (!index) fail(fmt::format("face {}: a vertex index that is no integer", face));
    if (*index < 0 || *index >= vertices_) {
      fail(fmt::format("face {}: vertex {} is out of range (0 to {})", face, *index, vertices_ - 1));
    }
  }

  const Element* find(std::string_view element_name) const {
    for (const Element& element : elements_) {
      if (element.name == element_name) return &element;
    }
    return nullptr;
  }

  [[noreturn]] void fail_truncated(const Element& element, std::int64_t have) const {
    fail(fmt::format("the file ends after {} of {} elements '{}': truncated", have, element.count,
                     element.name));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", name_, what));
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t position_ = 0;
  std::optional<Encoding> encoding_;
  std::vector<Element> elements_;
  std::int64_t vertices_ = 0;
};

}  // namespace

FileFacts check_ply(const FileBytes& bytes, const std::string& name) {
  return PlyCheck(bytes, name).run();
}

}  // namespace aerate
