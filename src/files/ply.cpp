#include <algorithm>
#include <array>
#include <cstdint>
#include <fmt/compile.h>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "files/assimp_import.h"
#include "files/formats.h"
#include "files/input_file.h"
#include "files/own_file.h"
#include "files/raw_bytes.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

enum class Kind { signed_integer, unsigned_integer, real };

struct Type {
  std::string_view name, other_name;
  Kind kind;
  std::size_t bytes;
};

constexpr std::array<Type, 8> kTypes{{
    {"char", "int8", Kind::signed_integer, 1},
    {"uchar", "uint8", Kind::unsigned_integer, 1},
    {"short", "int16", Kind::signed_integer, 2},
    {"ushort", "uint16", Kind::unsigned_integer, 2},
    {"int", "int32", Kind::signed_integer, 4},
    {"uint", "uint32", Kind::unsigned_integer, 4},
    {"float", "float32", Kind::real, 4},
    {"double", "float64", Kind::real, 8},
}};

// Null for an unknown name.
const Type* type_of(std::string_view name) {
  const auto found = std::find_if(kTypes.begin(), kTypes.end(), [&](const Type& type) {
    return name == type.name || name == type.other_name;
  });
  return found == kTypes.end() ? nullptr : &*found;
}

struct Property {
  std::string_view name;
  const Type* type;
  const Type* count_type;  // of a list, otherwise null
};

struct Element {
  std::string_view name;
  std::int64_t count;
  std::vector<Property> properties;
};

enum class Encoding { ascii, little_endian, big_endian };

std::optional<std::int64_t> read_integer(const char* bytes, const Type& type, Encoding encoding) {
  if (type.kind == Kind::real) return std::nullopt;
  const bool is_big = encoding == Encoding::big_endian;
  const auto byte = [&](std::size_t rank) { return bytes[is_big ? type.bytes - 1 - rank : rank]; };
  const char highest = byte(type.bytes - 1);
  std::int64_t value = type.kind == Kind::signed_integer && highest < 0 ? -1 : 0;
  for (std::size_t rank = type.bytes; rank-- > 0;)
    value = value << 8 | static_cast<unsigned char>(byte(rank));
  return value;
}

constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};

bool is_vertex_list(const Property& property) {
  return property.count_type != nullptr &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

// Makes a plain file of the coordinates and the corners of faces: assimp skips line feeds at the front of
// binary data, reads the front of "20mm" as 20, and keeps one triangle of each strip.
class PlyCheck {
 public:
  explicit PlyCheck(const InputFile& file)
      : file_(file), text_(file.text()), position_(start_of_text(text_)) {}

  PlainFile run() {
    read_header();
    const Element* const vertex = find("vertex");
    if (vertex == nullptr || vertex->count == 0) fail("no vertices");
    if (!has_elements("face") && !has_elements("tristrips")) fail("{} vertices but no faces", vertex->count);
    for (const std::string_view axis : kAxes) {
      const Property* const property = find(*vertex, axis);
      if (property == nullptr || property->count_type != nullptr)
        fail("its vertices have no coordinate {}", axis);
    }
    for (const std::string_view name : {"face", "tristrips"}) {
      const Element* const faces = find(name);
      if (faces != nullptr &&
          std::none_of(faces->properties.begin(), faces->properties.end(), is_vertex_list))
        fail("its {} have no list 'vertex_indices'", name == "face" ? "faces" : "strips");
    }
    vertices_ = vertex->count;
    if (is_text()) lines_.emplace(file_, position_);
    for (const Element& element : elements_) walk(element);
    PlainFile plain{plain_header(*vertex) + coordinates_ + faces_, triangles_};
    if (more_follows())
      plain.notices.emplace_back("more follows than the elements that the header promises; it is left out");
    return plain;
  }

 private:
  // A line end is no more.
  bool more_follows() {
    if (!is_text()) return text_.size() - position_ > 2;
    while (const auto line = lines_->next()) {
      std::string_view rest = *line;
      if (!take_token(rest).empty()) return true;
    }
    return false;
  }

  void read_header() {
    if (header_line() != "ply") fail("not a PLY file: its first line is not 'ply'");
    for (std::string_view line = header_line(); line != "end_header"; line = header_line()) {
      const std::string_view keyword = take_token(line);
      if (keyword == "format") {
        read_format(take_token(line));
      } else if (keyword == "element") {
        const std::string_view element = take_token(line);
        const auto count = parse_integer(take_token(line));
        if (!count || *count < 0 || *count > std::int64_t{kMostTriangles}) {
          fail("header: the number of elements '{:.20}' is not usable", element);
        }
        if (find(element) != nullptr) fail("header: two lists of elements '{:.20}'", element);
        elements_.push_back({element, *count, {}});
      } else if (keyword == "property") {
        read_property(line);
      } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
        fail("header: '{:.20}' is no keyword of PLY", keyword);
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
      fail("header: unknown format '{:.40}'", format);
    }
  }

  void read_property(std::string_view line) {
    if (elements_.empty()) fail("header: a property that belongs to no element");
    const Type* count_type = nullptr;
    std::string_view type_name = take_token(line);
    if (type_name == "list") {
      count_type = type_of(take_token(line));
      if (count_type == nullptr || count_type->kind == Kind::real)
        fail("header: a list without a count of integer type");
      type_name = take_token(line);
    }
    const Type* const type = type_of(type_name);
    if (type == nullptr) fail("header: unknown type '{:.20}'", type_name);
    elements_.back().properties.push_back({take_token(line), type, count_type});
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

  bool is_text() const { return encoding_ == Encoding::ascii; }

  void walk(const Element& element) {
    if (!is_text() && skip_unused(element)) return;
    for (std::int64_t i = 0; i < element.count; ++i) {
      if (is_text() && !element.properties.empty()) next_line(element, i);
      if (element.name == "vertex") {
        read_vertex(element, i);
      } else {
        for (const Property& property : element.properties) walk(element, property, i);
      }
    }
  }

  // Binary records of one size that hold nothing of a surface need no look at each.
  bool skip_unused(const Element& element) {
    std::size_t stride = 0;
    for (const Property& property : element.properties) {
      if (property.count_type != nullptr) return false;
      stride += property.type->bytes;
    }
    const auto held =
        stride == 0 ? element.count : static_cast<std::int64_t>((text_.size() - position_) / stride);
    if (held < element.count) fail_truncated(element, held);
    if (element.name == "vertex") return false;
    position_ += stride * static_cast<std::size_t>(element.count);
    return true;
  }

  void next_line(const Element& element, std::int64_t i) {
    do {
      const auto line = lines_->next();
      if (!line) fail_truncated(element, i);
      line_ = *line;
    } while (line_.find_first_not_of(" \t\v\f") == std::string_view::npos);
  }

  // Its coordinates are copied as they are, in the order x, y, z.
  void read_vertex(const Element& element, std::int64_t i) {
    std::array<std::string_view, 3> coordinates;
    for (const Property& property : element.properties) {
      const auto axis = std::find(kAxes.begin(), kAxes.end(), property.name);
      if (axis == kAxes.end()) {
        walk(element, property, i);
      } else {
        coordinates[static_cast<std::size_t>(axis - kAxes.begin())] = take(element, *property.type, i);
      }
    }
    for (const std::string_view coordinate : coordinates) {
      if (is_text()) {
        (coordinates_ += coordinate) += ' ';
      } else if (encoding_ == Encoding::little_endian) {
        coordinates_ += coordinate;
      } else {
        coordinates_.append(coordinate.rbegin(), coordinate.rend());
      }
    }
    if (is_text()) coordinates_.back() = '\n';
  }

  void walk(const Element& element, const Property& property, std::int64_t i) {
    std::int64_t count = 1;
    if (property.count_type != nullptr) {
      count = integer(take(element, *property.count_type, i), *property.count_type).value_or(-1);
      if (count < 0) fail("{} {}: a list without a count", element.name, i);
    }
    const bool is_face = element.name == "face", is_strip = element.name == "tristrips";
    if (!is_vertex_list(property) || !(is_face || is_strip)) {
      for (std::int64_t value = 0; value < count; ++value) take(element, *property.type, i);
      return;
    }
    corners_.clear();
    for (std::int64_t value = 0; value < count; ++value) {
      const auto index = integer(take(element, *property.type, i), *property.type);
      if (is_strip && index == -1) {
        add_strip();
      } else {
        check_index(index, element, i);
        corners_.push_back(static_cast<std::uint32_t>(*index));
      }
    }
    if (is_strip) {
      add_strip();
    } else {
      add_face(corners_);
    }
  }

  // The next value of element i.
  std::string_view take(const Element& element, const Type& type, std::int64_t i) {
    if (is_text()) {
      const std::string_view token = take_token(line_);
      if (token.empty())
        fail("{} {}: too few values in its line: truncated, or not this format", element.name, i);
      const bool is_whole = type.kind == Kind::real ? is_number(token) : parse_integer(token).has_value();
      if (!is_whole) lines_->fail("'{:.20}' is no {}", token, type.kind == Kind::real ? "number" : "integer");
      return token;
    }
    if (text_.size() - position_ < type.bytes) fail_truncated(element, i);
    position_ += type.bytes;
    return text_.substr(position_ - type.bytes, type.bytes);
  }

  // Empty for one that is no integer.
  std::optional<std::int64_t> integer(std::string_view value, const Type& type) const {
    return is_text() ? parse_integer(value) : read_integer(value.data(), type, *encoding_);
  }

  void check_index(std::optional<std::int64_t> index, const Element& element, std::int64_t i) const {
    if (!index) fail("{} {}: a vertex index that is no integer", element.name, i);
    if (*index < 0 || *index >= vertices_) {
      fail("{} {}: vertex {} is out of range (0 to {})", element.name, i, *index, vertices_ - 1);
    }
  }

  // Every other triangle of a strip runs the other way round. A repeated vertex makes the strip turn.
  void add_strip() {
    for (std::size_t i = 0; i + 2 < corners_.size(); ++i) {
      Triangle t{corners_[i], corners_[i + 1], corners_[i + 2]};
      if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) continue;
      if (i % 2 == 1) std::swap(t[0], t[1]);
      add_face(t);
    }
    corners_.clear();
  }

  void add_face(std::span<const std::uint32_t> corners) {
    if (corners.size() < 3) return;
    append(static_cast<std::uint32_t>(corners.size()));
    for (const std::uint32_t corner : corners) append(corner);
    if (is_text()) faces_.back() = '\n';
    ++face_count_;
    triangles_ += corners.size() - 2;
  }

  void append(std::uint32_t number) {
    if (is_text()) {
      fmt::format_to(std::back_inserter(faces_), FMT_COMPILE("{} "), number);
    } else {
      append_bytes(faces_, number);
    }
  }

  // The first byte after a binary header is no line feed.
  std::string plain_header(const Element& vertex) const {
    std::string header = "ply\nformat ";
    header += is_text() ? "ascii 1.0\n" : "binary_little_endian 1.0\nelement edge 1\nproperty uchar none\n";
    header += fmt::format("element vertex {}\n", vertices_);
    for (const std::string_view axis : kAxes)
      header += fmt::format("property {} {}\n", find(vertex, axis)->type->name, axis);
    header +=
        fmt::format("element face {}\nproperty list uint uint vertex_indices\nend_header\n", face_count_);
    if (!is_text()) header += '\1';
    return header;
  }

  const Element* find(std::string_view element_name) const { return find_named(elements_, element_name); }

  static const Property* find(const Element& element, std::string_view property_name) {
    return find_named(element.properties, property_name);
  }

  // Null if there is none.
  template <typename Named>
  static const Named* find_named(const std::vector<Named>& list, std::string_view name) {
    const auto found =
        std::find_if(list.begin(), list.end(), [&](const Named& one) { return one.name == name; });
    return found == list.end() ? nullptr : &*found;
  }

  bool has_elements(std::string_view element_name) const {
    const Element* const element = find(element_name);
    return element != nullptr && element->count > 0;
  }

  [[noreturn]] void fail_truncated(const Element& element, std::int64_t have) const {
    fail("the file ends after {} of {} elements '{}': truncated", have, element.count, element.name);
  }

  template <typename... Arguments>
  [[noreturn]] void fail(fmt::format_string<Arguments...> what, Arguments&&... arguments) const {
    fail_to_read(file_, what, std::forward<Arguments>(arguments)...);
  }

  const InputFile& file_;
  std::string_view text_;
  std::size_t position_;
  std::optional<LineReader> lines_;  // of a text file, after its header
  std::string_view line_;            // what is left of the current one
  std::optional<Encoding> encoding_;
  std::vector<Element> elements_;
  std::int64_t vertices_ = 0;
  std::vector<std::uint32_t> corners_;  // of the list that is read
  std::string coordinates_, faces_;     // of the plain file
  std::size_t face_count_ = 0, triangles_ = 0;
};

LoadedModel read_ply(InputFile& file, const LoadOptions& options) {
  const PlainFile plain = PlyCheck(file).run();
  file.data.reset();
  return import_with_assimp(file.name, plain, "ply", millimetres_per_unit(options));
}

// Of our own files: a face is the number 3 and its vertices.
constexpr std::size_t kFaceBytes = 1 + sizeof(Triangle);

void write_ply(const Mesh& mesh, OutputFile& file) {
  file.write(
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment millimetres, written by aerate\n"
                  "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
                  "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                  mesh.positions.size(), mesh.triangles.size()));
  write_records(file, mesh.positions.size(), sizeof(Vec3f),
                [&](std::size_t i, std::string& out) { append_bytes(out, mesh.positions[i]); });
  write_records(file, mesh.triangles.size(), kFaceBytes, [&](std::size_t i, std::string& out) {
    out += '\3';
    append_bytes(out, mesh.triangles[i]);
  });
}

// The number in a header line "element NAME number".
std::size_t count_in(const OwnFile& file, std::string_view line, std::string_view name) {
  std::string_view rest = line;
  take_token(rest);
  const bool is_named = take_token(rest) == name;
  const auto count = parse_number<std::size_t>(take_token(rest));
  if (!is_named || !count)
    file.fail(fmt::format("'{}' instead of the number of its elements '{}'", line, name));
  return *count;
}

Mesh read_written_ply(OwnFile& file) {
  std::size_t vertex_count = 0, face_count = 0;
  for (auto line = file.next_line(); line != "end_header"; line = file.next_line()) {
    if (!line) file.fail("its header ends too early");
    if (line->starts_with("element v")) vertex_count = count_in(file, *line, "vertex");
    if (line->starts_with("element f")) face_count = count_in(file, *line, "face");
  }
  file.require_room_for(vertex_count * sizeof(Vec3f) + face_count * kFaceBytes);
  std::vector<Vec3f> positions;
  positions.reserve(vertex_count);
  file.for_each_record<sizeof(Vec3f)>(
      vertex_count, [&](const char* vertex) { positions.push_back(value_at<Vec3f>(vertex)); });
  Welder welder(face_count);
  file.for_each_record<kFaceBytes>(face_count, [&](const char* face) {
    const auto corners = value_at<Triangle>(face + 1);
    const bool exist = std::all_of(corners.begin(), corners.end(), [&](auto v) { return v < vertex_count; });
    if (*face != 3 || !exist) file.fail("a face is no triangle of its vertices");
    welder.add_triangle(positions[corners[0]], positions[corners[1]], positions[corners[2]]);
  });
  file.require_end();
  return std::move(welder).finish();
}

}  // namespace

constinit const MeshFormat MeshFormat::ply{"PLY", ".ply", read_ply, write_ply, read_written_ply};

}  // namespace aerate
