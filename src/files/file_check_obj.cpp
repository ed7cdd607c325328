#include <fmt/format.h>
#include <string_view>

#include "core/error.h"
#include "files/file_check.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

class ObjCheck {
 public:
  ObjCheck(const FileBytes& bytes, const std::string& name) : lines_(bytes.text()), name_(name) {}

  FileFacts run() {
    while (auto line = lines_.next()) {
      if (line->find('\0') != std::string_view::npos) fail("binary data: not an OBJ file");
      std::string_view rest = *line;
      const std::string_view keyword = take_token(rest);
      if (keyword == "v") {
        check_vertex(rest);
      } else if (keyword == "f") {
        check_face(rest);
      }
    }
    if (faces_ == 0) {
      throw InputError(
          fmt::format("{}: no faces ({} vertices): not a surface, or not an OBJ file", name_, vertices_));
    }
    // A forward reference is allowed, so the highest index can only be judged at the end.
    if (highest_index_ > vertices_) {
      throw InputError(
          fmt::format("{}: line {}: vertex {} of a face is out of range (the file has {}): truncated?", name_,
                      highest_index_line_, highest_index_, vertices_));
    }
    // The importer numbers corners, not vertices, and leaves out faces of one or two corners.
    return {.face_count = std::nullopt, .vertex_count = static_cast<std::size_t>(vertices_)};
  }

 private:
  void check_vertex(std::string_view line) {
    for (int axis = 0; axis < 3; ++axis) {
      if (take_token(line).empty()) fail("a vertex of fewer than three coordinates: truncated?");
    }
    ++vertices_;
  }

  void check_face(std::string_view line) {
    int corners = 0;
    for (std::string_view corner = take_token(line); !corner.empty(); corner = take_token(line)) {
      if (corner.front() == '#' || corner == "\\") break;
      const auto index = parse_integer(corner.substr(0, corner.find('/')));
      if (!index || *index == 0) fail(fmt::format("'{:.20}' is no vertex of a face", corner));
      if (*index < -vertices_) {
        fail(fmt::format("vertex {} of a face reaches back beyond the {} that there are", *index, vertices_));
      }
      if (*index > highest_index_) {
        highest_index_ = *index;
        highest_index_line_ = lines_.number();
      }
      ++corners;
    }
    if (corners == 0) fail("a face without corners");
    ++faces_;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: line {}: {}", name_, lines_.number(), what));
  }

  LineReader lines_;
  const std::string& name_;
  std::int64_t vertices_ = 0, faces_ = 0;
  std::int64_t highest_index_ = 0;
  std::size_t highest_index_line_ = 0;
};

}  // namespace

FileFacts check_obj(const FileBytes& bytes, const std::string& name) {
  return ObjCheck(bytes, name).run();
}

}  // namespace aerate
