#include <cstring>
#include <string_view>

#include "files/assimp_import.h"
#include "files/formats.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

constexpr std::int64_t kMaxCorners = 9;       // the importer leaves out faces with more
constexpr std::size_t kMaxLineLength = 4000;  // it reads lines of up to 4096 bytes

// Walks through the lines that say something, and copies them, stripped of comments, to the front of the
// buffer: the importer takes every line for a vertex or a face.
class OffCheck {
 public:
  explicit OffCheck(InputFile& file) : file_(file), lines_(file), write_(file.data.get()) {}

  // The number of faces.
  std::size_t run() {
    read_header();
    for (std::int64_t i = 0; i < vertices_; ++i) {
      std::string_view line = require_line("vertices", i, vertices_);
      for (int axis = 0; axis < 3; ++axis) {
        if (take_token(line).empty()) lines_.fail("a vertex of fewer than three coordinates");
      }
    }
    for (std::int64_t i = 0; i < faces_; ++i) check_face(require_line("faces", i, faces_));
    file_.size = static_cast<std::size_t>(write_ - file_.data.get());
    return static_cast<std::size_t>(faces_);
  }

 private:
  void read_header() {
    std::string_view line = require_line("lines", 0, 1);
    if (line.find("OFF") == std::string_view::npos || line.find("OFF") > 4) {
      lines_.fail("no OFF file: its first line does not say OFF");
    }
    take_token(line);
    std::string_view first = take_token(line);
    if (first.empty()) {
      line = require_line("lines", 1, 2);
      first = take_token(line);
    }
    const auto vertices = parse_integer(first);
    const auto faces = parse_integer(take_token(line));
    if (!vertices || !faces || *vertices < 0 || *faces < 0) {
      lines_.fail("no numbers of vertices and faces (binary OFF is not supported)");
    }
    if (*vertices == 0 || *faces == 0) lines_.fail("{} vertices and {} faces", *vertices, *faces);
    vertices_ = *vertices;
    faces_ = *faces;
    // A line takes two bytes at least: counts that cannot be true are caught before memory is reserved.
    const auto most = static_cast<std::int64_t>(file_.size / 2 + 1);
    if (vertices_ > most || faces_ > most) {
      lines_.fail("{} vertices and {} faces do not fit into {} bytes: truncated", vertices_, faces_,
                  file_.size);
    }
  }

  void check_face(std::string_view line) {
    const auto corners = parse_integer(take_token(line));
    if (!corners || *corners < 1) lines_.fail("a face without a number of corners");
    if (*corners > kMaxCorners) {
      lines_.fail("a face of {} corners, more than {}: triangulate the model first", *corners, kMaxCorners);
    }
    for (std::int64_t corner = 0; corner < *corners; ++corner) {
      const auto index = parse_integer(take_token(line));
      if (!index) lines_.fail("a face with fewer corners than it says");
      if (*index < 0 || *index >= vertices_) {
        lines_.fail("vertex {} of a face is out of range (0 to {})", *index, vertices_ - 1);
      }
    }
  }

  std::string_view require_line(std::string_view what, std::int64_t have, std::int64_t want) {
    while (const auto line = lines_.next()) {
      const std::string_view content = line->substr(0, line->find('#'));
      if (content.find_first_not_of(" \t\v\f") == std::string_view::npos) continue;
      if (content.size() > kMaxLineLength) lines_.fail("longer than {} characters", kMaxLineLength);
      return keep(content);
    }
    lines_.fail("the file ends after {} of {} {}: truncated", have, want, what);
  }

  std::string_view keep(std::string_view line) {
    std::memmove(write_, line.data(), line.size());
    const std::string_view kept(write_, line.size());
    write_ += line.size();
    // Only a last line without an end leaves no room for one; it needs none.
    if (write_ != file_.data.get() + file_.size) *write_++ = '\n';
    return kept;
  }

  InputFile& file_;
  LineReader lines_;
  char* write_;
  std::int64_t vertices_ = 0, faces_ = 0;
};

LoadedModel read_off(InputFile& file, const LoadOptions& options) {
  const std::size_t faces = OffCheck(file).run();
  return import_with_assimp(file, "off", faces, millimetres_per_unit(options));
}

}  // namespace

constinit const MeshFormat MeshFormat::off{"OFF", ".off", read_off};

}  // namespace aerate
