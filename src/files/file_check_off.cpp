#include <cstring>
#include <fmt/format.h>
#include <string_view>

#include "core/error.h"
#include "files/file_check.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

constexpr std::int64_t kMaxCorners = 9;       // the importer leaves out faces with more
constexpr std::size_t kMaxLineLength = 4000;  // it reads lines of up to 4096 bytes

// Walks through the lines that say something, and copies them, stripped of comments, to the front of the
// buffer: the importer takes every line for a vertex or a face.
class OffCheck {
 public:
  OffCheck(FileBytes& bytes, const std::string& name)
      : bytes_(bytes), lines_(bytes.text()), write_(bytes.data.get()), name_(name) {}

  FileFacts run() {
    read_header();
    for (std::int64_t i = 0; i < vertices_; ++i) {
      std::string_view line = require_line("vertices", i, vertices_);
      for (int axis = 0; axis < 3; ++axis) {
        if (take_token(line).empty()) fail("a vertex of fewer than three coordinates");
      }
    }
    for (std::int64_t i = 0; i < faces_; ++i) check_face(require_line("faces", i, faces_));
    bytes_.size = static_cast<std::size_t>(write_ - bytes_.data.get());
    return {.face_count = static_cast<std::size_t>(faces_),
            .vertex_count = static_cast<std::size_t>(vertices_)};
  }

 private:
  void read_header() {
    std::string_view line = require_line("lines", 0, 1);
    if (line.find("OFF") == std::string_view::npos || line.find("OFF") > 4) {
      fail("no OFF file: its first line does not say OFF");
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
      fail("no numbers of vertices and faces (binary OFF is not supported)");
    }
    if (*vertices == 0 || *faces == 0) fail(fmt::format("{} vertices and {} faces", *vertices, *faces));
    vertices_ = *vertices;
    faces_ = *faces;
    // A line takes two bytes at least: counts that cannot be true are caught before memory is reserved.
    const auto most = static_cast<std::int64_t>(bytes_.size / 2 + 1);
    if (vertices_ > most || faces_ > most) {
      fail(fmt::format("{} vertices and {} faces do not fit into {} bytes: truncated", vertices_, faces_,
                       bytes_.size));
    }
  }

  void check_face(std::string_view line) {
    const auto corners = parse_integer(take_token(line));
    if (!corners || *corners < 1) fail("a face without a number of corners");
    if (*corners > kMaxCorners) {
      fail(fmt::format("a face of {} corners, more than {}: triangulate the model first", *corners,
                       kMaxCorners));
    }
    for (std::int64_t corner = 0; corner < *corners; ++corner) {
      const auto index = parse_integer(take_token(line));
      if (!index) fail("a face with fewer corners than it says");
      if (*index < 0 || *index >= vertices_) {
        fail(fmt::format("vertex {} of a face is out of range (0 to {})", *index, vertices_ - 1));
      }
    }
  }

  std::string_view require_line(std::string_view what, std::int64_t have, std::int64_t want) {
    while (const auto line = lines_.next()) {
      const std::string_view content = line->substr(0, line->find('#'));
      if (content.find_first_not_of(" \t\v\f") == std::string_view::npos) continue;
      if (content.size() > kMaxLineLength) fail(fmt::format("longer than {} characters", kMaxLineLength));
      return keep(content);
    }
    fail(fmt::format("the file ends after {} of {} {}: truncated", have, want, what));
  }

  std::string_view keep(std::string_view line) {
    std::memmove(write_, line.data(), line.size());
    const std::string_view kept(write_, line.size());
    write_ += line.size();
    // Only a last line without an end leaves no room for one; it needs none.
    if (write_ != bytes_.data.get() + bytes_.size) *write_++ = '\n';
    return kept;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: line {}: {}", name_, lines_.number(), what));
  }

  FileBytes& bytes_;
  LineReader lines_;
  char* write_;
  const std::string& name_;
  std::int64_t vertices_ = 0, faces_ = 0;
};

}  // namespace

FileFacts check_off(FileBytes& bytes, const std::string& name) {
  return OffCheck(bytes, name).run();
}

}  // namespace aerate
