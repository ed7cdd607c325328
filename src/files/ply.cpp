#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "files/assimp_import.h"
#include "files/formats.h"
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

bool is_vertex_list(const Element& element, const Property& property) {
  return element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index");
}

class PlyCheck {
 public:
  explicit PlyCheck(const InputFile& file) : file_(file), text_(file.text()) {}

  // The number of faces.
  std::size_t run() {
    read_header();
    const Element* const vertex = find("vertex");
    const Element* const face = find("face");
    if (vertex == nullptr || vertex->count == 0) fail("no vertices");
    if (face == nullptr || face->count == 0) fail("{} vertices but no faces", vertex->count);
    for (const std::string_view axis : {"x", "y", "z"}) {
      if (std::none_of(vertex->properties.begin(), vertex->properties.end(),
                       [&](const Property& p) { return p.name == axis && p.count_type == nullptr; })) {
        fail("its vertices have no coordinate {}", axis);
      }
    }
    if (std::none_of(face->properties.begin(), face->properties.end(), [&](const Property& p) {
          return is_vertex_list(*face, p) && p.count_type != nullptr;
        })) {
      fail("its faces have no list 'vertex_indices'");
    }
    vertices_ = vertex->count;
    lines_.emplace(file_, position_);
    for (const Element& element : elements_) walk(element);
    return static_cast<std::size_t>(face->count);
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
        if (!count || *count < 0 || *count > std::int64_t{kMostTriangles}) {
          fail("header: the number of elements '{:.20}' is not usable", element);
        }
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

  void walk(const Element& element) {
    const bool is_text = encoding_ == Encoding::ascii;
    if (!is_text && skip_records_of_one_size(element)) return;
    for (std::int64_t i = 0; i < element.count; ++i) {
      if (is_text) {
        const auto line = lines_->next();
        if (!line) fail_truncated(element, i);
        line_ = *line;
      }
      for (const Property& property : element.properties) walk(element, property, i);
    }
  }

  // Binary records without lists need no look at each.
  bool skip_records_of_one_size(const Element& element) {
    std::size_t stride = 0;
    for (const Property& property : element.properties) {
      if (property.count_type != nullptr) return false;
      stride += property.type->bytes;
    }
    const auto held =
        stride == 0 ? element.count : static_cast<std::int64_t>((text_.size() - position_) / stride);
    if (held < element.count) fail_truncated(element, held);
    position_ += stride * static_cast<std::size_t>(element.count);
    return true;
  }

  void walk(const Element& element, const Property& property, std::int64_t i) {
    std::int64_t count = 1;
    if (property.count_type != nullptr) {
      count = take(element, *property.count_type, i).value_or(-1);
      if (count < 0) fail("{} {}: a list without a count", element.name, i);
    }
    for (std::int64_t value = 0; value < count; ++value) {
      const std::optional<std::int64_t> index = take(element, *property.type, i);
      if (is_vertex_list(element, property)) check_index(index, i);
    }
  }

  // The next value of element i: empty for one that is no integer.
  std::optional<std::int64_t> take(const Element& element, const Type& type, std::int64_t i) {
    if (encoding_ == Encoding::ascii) {
      const std::string_view token = take_token(line_);
      if (token.empty())
        fail("{} {}: too few values in its line: truncated, or not this format", element.name, i);
      return parse_integer(token);
    }
    if (text_.size() - position_ < type.bytes) fail_truncated(element, i);
    position_ += type.bytes;
    return read_integer(text_.data() + position_ - type.bytes, type, *encoding_);
  }

  void check_index(std::optional<std::int64_t> index, std::int64_t face) {
    if (!index) fail("face {}: a vertex index that is no integer", face);
    if (*index < 0 || *index >= vertices_) {
      fail("face {}: vertex {} is out of range (0 to {})", face, *index, vertices_ - 1);
    }
  }

  const Element* find(std::string_view element_name) const {
    for (const Element& element : elements_) {
      if (element.name == element_name) return &element;
    }
    return nullptr;
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
  std::size_t position_ = 0;
  std::optional<LineReader> lines_;  // of a text file, after its header
  std::string_view line_;            // what is left of the current one
  std::optional<Encoding> encoding_;
  std::vector<Element> elements_;
  std::int64_t vertices_ = 0;
};

LoadedModel read_ply(InputFile& file, const LoadOptions& options) {
  return import_with_assimp(file, "ply", PlyCheck(file).run(), millimetres_per_unit(options));
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
