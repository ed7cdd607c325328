#include <algorithm>
#include <array>
#include <charconv>
#include <fmt/compile.h>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "files/assimp_import.h"
#include "files/decimal.h"
#include "files/formats.h"
#include "files/own_file.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

// Makes a plain file of vertices, faces and what assimp tells parts apart by: it leaves out whole meshes for a
// texture coordinate that is not there, takes indented lines for comments, and opens the files of materials.
class ObjCheck {
 public:
  explicit ObjCheck(const InputFile& file) : file_(file), lines_(file, start_of_text(file.text())) {}

  PlainFile run() {
    while (const auto line = lines_.next()) {
      begin_line(*line);
      const std::string_view keyword = next_token();
      if (keyword == "v") {
        read_vertex();
      } else if (keyword == "f") {
        read_face();
      } else if (keyword == "o" || keyword == "g" || keyword == "usemtl") {
        keep_name(keyword);
      }
      while (continues_) begin_next_line();
    }
    if (faces_ == 0)
      fail_to_read(file_, "no faces ({} vertices): not a surface, or not an OBJ file", vertices_);
    // A forward reference is allowed, so the highest index can only be judged at the end.
    if (highest_index_ > vertices_) {
      fail_to_read(file_, "line {}: vertex {} of a face is out of range (the file has {}): truncated?",
                   highest_index_line_, highest_index_, vertices_);
    }
    return std::move(plain_);
  }

 private:
  // A line that ends with a backslash goes on in the next.
  void begin_line(std::string_view line) {
    if (line.find('\0') != std::string_view::npos) lines_.fail("binary data: not an OBJ file");
    continues_ = line.ends_with('\\');
    if (continues_) line.remove_suffix(1);
    line_ = line;
  }

  void begin_next_line() {
    const auto line = lines_.next();
    begin_line(line.value_or(""));
  }

  // Empty at the end of the line or where a comment begins.
  std::string_view next_token() {
    std::string_view token = take_token(line_);
    while (token.empty() && continues_) {
      begin_next_line();
      token = take_token(line_);
    }
    const std::size_t comment = find_comment(token);
    if (comment != std::string_view::npos) {
      line_ = {};
      continues_ = false;
    }
    return token.substr(0, comment);
  }

  // Three coordinates, which may be followed by a weight, which is for curves alone, or a colour, with or without
  // its opacity.
  void read_vertex() {
    constexpr std::size_t kMostNumbers = 7;
    std::array<std::string_view, kMostNumbers> numbers;
    std::size_t count = 0;
    for (std::string_view token = next_token(); !token.empty(); token = next_token()) {
      if (!is_number(token)) lines_.fail("'{:.20}' is no number", token);
      if (count == kMostNumbers) lines_.fail("a vertex of more than {} numbers", kMostNumbers);
      numbers[count++] = token;
    }
    if (count < 3) lines_.fail("a vertex of fewer than three coordinates: truncated?");
    if (count == 5) lines_.fail("a vertex of {} numbers", count);
    plain_.bytes += 'v';
    for (std::size_t i = 0; i < 3; ++i) {
      // assimp counts what begins with a point as no number, and leaves out the vertex.
      plain_.bytes += numbers[i].starts_with('.') ? " 0" : " ";
      plain_.bytes += numbers[i];
    }
    plain_.bytes += '\n';
    ++vertices_;
  }

  void read_face() {
    corners_.clear();
    for (std::string_view corner = next_token(); !corner.empty(); corner = next_token()) {
      const auto index = parse_integer(corner.substr(0, corner.find('/')));
      if (!index || *index == 0) lines_.fail("'{:.20}' is no vertex of a face", corner);
      if (*index < -vertices_)
        lines_.fail("vertex {} of a face reaches back beyond the {} that there are", *index, vertices_);
      if (*index > highest_index_) {
        highest_index_ = *index;
        highest_index_line_ = lines_.number();
      }
      corners_.push_back(*index < 0 ? vertices_ + 1 + *index : *index);
    }
    if (corners_.empty()) lines_.fail("a face without corners");
    ++faces_;
    // Points and lines have no part in a surface.
    if (corners_.size() < 3) return;
    plain_.bytes += 'f';
    for (const std::int64_t corner : corners_)
      fmt::format_to(std::back_inserter(plain_.bytes), FMT_COMPILE(" {}"), corner);
    plain_.bytes += '\n';
    plain_.triangles += corners_.size() - 2;
  }

  // The rest of the line is a name. assimp begins a new line at a form feed.
  void keep_name(std::string_view keyword) {
    std::string name(line_);
    std::replace(name.begin(), name.end(), '\f', ' ');
    ((plain_.bytes += keyword) += name) += '\n';
  }

  const InputFile& file_;
  LineReader lines_;
  std::string_view line_;  // what is left of the current one
  bool continues_ = false;
  PlainFile plain_;
  std::vector<std::int64_t> corners_;  // of the face that is read
  std::int64_t vertices_ = 0, faces_ = 0;
  std::int64_t highest_index_ = 0;
  std::size_t highest_index_line_ = 0;
};

LoadedModel read_obj(InputFile& file, const LoadOptions& options) {
  const PlainFile plain = ObjCheck(file).run();
  file.data.reset();
  return import_with_assimp(file.name, plain, "obj", millimetres_per_unit(options));
}

void write_obj(const Mesh& mesh, OutputFile& file) {
  file.write("# millimetres, written by aerate\n");
  write_records(file, mesh.positions.size(), 40, [&](std::size_t i, std::string& out) {
    const Vec3f p = mesh.positions[i];
    fmt::format_to(std::back_inserter(out), FMT_COMPILE("v {} {} {}\n"), Decimal{p.x}, Decimal{p.y},
                   Decimal{p.z});
  });
  write_records(file, mesh.triangles.size(), 28, [&](std::size_t i, std::string& out) {
    const auto [a, b, c] = mesh.triangles[i];
    fmt::format_to(std::back_inserter(out), FMT_COMPILE("f {} {} {}\n"), std::uint64_t{a} + 1,
                   std::uint64_t{b} + 1, std::uint64_t{c} + 1);
  });
}

// Three numbers, each after a space, and nothing else.
template <typename Number>
bool scan_three(std::string_view text, std::array<Number, 3>& numbers) {
  for (Number& number : numbers) {
    if (text.empty() || text.front() != ' ') return false;
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), number);
    if (error != std::errc()) return false;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  return text.empty();
}

Mesh read_written_obj(OwnFile& file) {
  std::vector<Vec3f> positions;
  Welder welder(0);
  std::size_t number = 0;
  while (const auto line = file.next_line()) {
    ++number;
    std::array<float, 3> p{};
    std::array<std::uint32_t, 3> corners{};
    const std::string_view rest = std::string_view(*line).substr(line->empty() ? 0 : 1);
    if (line->starts_with('v') && scan_three(rest, p)) {
      positions.push_back({p[0], p[1], p[2]});
    } else if (line->starts_with('f') && scan_three(rest, corners)) {
      for (const std::uint32_t corner : corners) {
        if (corner == 0 || corner > positions.size())
          file.fail(fmt::format("line {} names a vertex that is not there", number));
      }
      welder.add_triangle(positions[corners[0] - 1], positions[corners[1] - 1], positions[corners[2] - 1]);
    } else if (!line->empty() && !line->starts_with('#')) {
      file.fail(fmt::format("line {}", number));
    }
  }
  return std::move(welder).finish();
}

}  // namespace

constinit const MeshFormat MeshFormat::obj{"OBJ", ".obj", read_obj, write_obj, read_written_obj};

}  // namespace aerate
