#include <fmt/compile.h>
#include <iterator>
#include <string_view>
#include <utility>

#include "files/assimp_import.h"
#include "files/formats.h"
#include "files/input_file.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

constexpr std::int64_t kMaxCorners = 9;  // the importer leaves out faces with more

// Makes a plain file of it, without comments and with a vertex or a face on each line, since the importer takes
// every line for one of them. Numbers may be spread over lines. What follows a vertex or a face on its last line
// (a normal, a colour) is left out.
class OffCheck {
 public:
  explicit OffCheck(const InputFile& file) : file_(file), lines_(file, start_of_text(file.text())) {}

  PlainFile run() {
    read_header();
    for (std::int64_t i = 0; i < vertices_; ++i) read_vertex(i);
    for (std::int64_t i = 0; i < faces_; ++i) read_face(i);
    if (!next_token().empty())
      plain_.notices.push_back(
          fmt::format("from line {} on more follows than the {} faces that the header promises; it is left "
                      "out",
                      lines_.number(), faces_));
    return std::move(plain_);
  }

 private:
  // What may stand before "OFF" says what each vertex has: texture, colour, normal, a fourth coordinate.
  void read_header() {
    std::string_view keyword = next_token();
    const std::string_view whole = keyword;
    for (const std::string_view part : {"ST", "C", "N"}) {
      if (keyword.starts_with(part)) keyword.remove_prefix(part.size());
    }
    if (keyword == "4OFF") {
      coordinates_ = 4;
    } else if (keyword == "nOFF" || keyword == "4nOFF") {
      lines_.fail("'{}', with another number of dimensions than three, is not read", whole);
    } else if (keyword != "OFF") {
      lines_.fail("no OFF file: its first line does not say OFF");
    }
    const auto vertices = parse_integer(next_token());
    const std::size_t line_of_vertices = lines_.number();
    const auto faces = parse_integer(next_token());
    if (!vertices || !faces || *vertices < 0 || *faces < 0) {
      lines_.fail("no numbers of vertices and faces (binary OFF is not supported)");
    }
    // The number of edges says nothing, and some leave it out where it would stand on the same line.
    if (lines_.number() != line_of_vertices) next_token();
    line_ = {};
    if (*vertices == 0 || *faces == 0) lines_.fail("{} vertices and {} faces", *vertices, *faces);
    vertices_ = *vertices;
    faces_ = *faces;
    // Each takes two bytes at least: counts that cannot be true are caught before memory is reserved.
    const auto most = static_cast<std::int64_t>(file_.size / 2 + 1);
    if (vertices_ > most || faces_ > most) {
      lines_.fail("{} vertices and {} faces do not fit into {} bytes: truncated", vertices_, faces_,
                  file_.size);
    }
    plain_.bytes = fmt::format("{}OFF\n{} {} 0\n", coordinates_ == 4 ? "4" : "", vertices_, faces_);
  }

  void read_vertex(std::int64_t i) {
    for (int axis = 0; axis < coordinates_; ++axis) {
      const std::string_view token = next_token();
      if (token.empty()) fail_truncated(i, vertices_, "vertices");
      if (!is_number(token)) lines_.fail("'{:.20}' is no number", token);
      if (axis > 0) plain_.bytes += ' ';
      plain_.bytes += token;
    }
    end_line();
  }

  void read_face(std::int64_t i) {
    const std::string_view count = next_token();
    if (count.empty()) fail_truncated(i, faces_, "faces");
    const auto corners = parse_integer(count);
    if (!corners || *corners < 1) lines_.fail("a face without a number of corners");
    if (*corners > kMaxCorners) {
      lines_.fail("a face of {} corners, more than {}: triangulate the model first", *corners, kMaxCorners);
    }
    append(*corners);
    for (std::int64_t corner = 0; corner < *corners; ++corner) {
      const std::string_view token = next_token();
      if (token.empty()) fail_truncated(i, faces_, "faces");
      const auto index = parse_integer(token);
      if (!index) lines_.fail("'{:.20}' is no vertex of a face", token);
      if (*index < 0 || *index >= vertices_) {
        lines_.fail("vertex {} of a face is out of range (0 to {})", *index, vertices_ - 1);
      }
      plain_.bytes += ' ';
      append(*index);
    }
    end_line();
    if (*corners >= 3) plain_.triangles += static_cast<std::size_t>(*corners - 2);
  }

  void append(std::int64_t number) {
    fmt::format_to(std::back_inserter(plain_.bytes), FMT_COMPILE("{}"), number);
  }

  void end_line() {
    plain_.bytes += '\n';
    line_ = {};
  }

  // From the next line that has one, if need be; empty at the end of the file.
  std::string_view next_token() {
    std::string_view token = take_token(line_);
    while (token.empty()) {
      const auto line = lines_.next();
      if (!line) return {};
      line_ = line->substr(0, find_comment(*line));
      token = take_token(line_);
    }
    return token;
  }

  [[noreturn]] void fail_truncated(std::int64_t have, std::int64_t want, const char* what) const {
    lines_.fail("the file ends after {} of {} {}: truncated", have, want, what);
  }

  const InputFile& file_;
  LineReader lines_;
  std::string_view line_;  // what is left of the current one
  PlainFile plain_;
  std::int64_t vertices_ = 0, faces_ = 0;
  int coordinates_ = 3;  // of a vertex
};

LoadedModel read_off(InputFile& file, const LoadOptions& options) {
  const PlainFile plain = OffCheck(file).run();
  file.data.reset();
  return import_with_assimp(file.name, plain, "off", millimetres_per_unit(options));
}

}  // namespace

constinit const MeshFormat MeshFormat::off{"OFF", ".off", read_off};

}  // namespace aerate
