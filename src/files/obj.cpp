#include <array>
#include <charconv>
#include <fmt/compile.h>
#include <iterator>

#include "files/assimp_import.h"
#include "files/decimal.h"
#include "files/formats.h"
#include "files/own_file.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

class ObjCheck {
 public:
  explicit ObjCheck(const InputFile& file) : file_(file), lines_(file) {}

  void run() {
    while (auto line = lines_.next()) {
      if (line->find('\0') != std::string_view::npos) lines_.fail("binary data: not an OBJ file");
      std::string_view rest = *line;
      const std::string_view keyword = take_token(rest);
      if (keyword == "v") {
        check_vertex(rest);
      } else if (keyword == "f") {
        check_face(rest);
      }
    }
    if (faces_ == 0)
      fail_to_read(file_, "no faces ({} vertices): not a surface, or not an OBJ file", vertices_);
    // A forward reference is allowed, so the highest index can only be judged at the end.
    if (highest_index_ > vertices_) {
      fail_to_read(file_, "line {}: vertex {} of a face is out of range (the file has {}): truncated?",
                   highest_index_line_, highest_index_, vertices_);
    }
  }

 private:
  void check_vertex(std::string_view line) {
    for (int axis = 0; axis < 3; ++axis) {
      if (take_token(line).empty()) lines_.fail("a vertex of fewer than three coordinates: truncated?");
    }
    ++vertices_;
  }

  void check_face(std::string_view line) {
    int corners = 0;
    for (std::string_view corner = take_token(line); !corner.empty(); corner = take_token(line)) {
      if (corner.front() == '#' || corner == "\\") break;
      const auto index = parse_integer(corner.substr(0, corner.find('/')));
      if (!index || *index == 0) lines_.fail("'{:.20}' is no vertex of a face", corner);
      if (*index < -vertices_)
        lines_.fail("vertex {} of a face reaches back beyond the {} that there are", *index, vertices_);
      if (*index > highest_index_) {
        highest_index_ = *index;
        highest_index_line_ = lines_.number();
      }
      ++corners;
    }
    if (corners == 0) lines_.fail("a face without corners");
    ++faces_;
  }

  const InputFile& file_;
  LineReader lines_;
  std::int64_t vertices_ = 0, faces_ = 0;
  std::int64_t highest_index_ = 0;
  std::size_t highest_index_line_ = 0;
};

// assimp leaves out faces of one or two corners, so the number of faces promises nothing.
LoadedModel read_obj(InputFile& file, const LoadOptions& options) {
  ObjCheck(file).run();
  return import_with_assimp(file, "obj", std::nullopt, millimetres_per_unit(options));
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
