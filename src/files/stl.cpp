#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/listed.h"
#include "files/assimp_import.h"
#include "files/formats.h"
#include "files/input_file.h"
#include "files/own_file.h"
#include "files/part_writer.h"
#include "files/raw_bytes.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

// A binary file: a header that may hold anything, the number of facets, and each with a normal, three corners
// and two bytes that mean nothing.
using Corners = std::array<Vec3f, 3>;
constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kPreambleBytes = kHeaderBytes + sizeof(std::uint32_t);
constexpr std::size_t kFacetBytes = sizeof(Vec3f) + sizeof(Corners) + 2;

std::size_t promised_facets(const char* preamble) {
  return value_at<std::uint32_t>(preamble + kHeaderBytes);
}

Corners corners_of(const char* facet) {
  return value_at<Corners>(facet + sizeof(Vec3f));
}

// Both kinds may begin with "solid"; binary data has zero bytes early on, text has none.
bool looks_like_text(std::string_view text) {
  constexpr std::string_view kKeyword = "solid";
  const std::size_t start = text.find_first_not_of(" \t\r\n", start_of_text(text));
  if (start == std::string_view::npos || text.size() - start < kKeyword.size()) return false;
  for (std::size_t i = 0; i < kKeyword.size(); ++i) {
    if (to_lower_ascii(text[start + i]) != kKeyword[i]) return false;
  }
  return text.substr(0, 1024).find('\0') == std::string_view::npos;
}

bool is_binary_of_its_size(const InputFile& file) {
  return file.size >= kPreambleBytes &&
         file.size == kPreambleBytes + promised_facets(file.data.get()) * kFacetBytes;
}

// The number of facets. Programs that do not know it when they begin to write leave any number in the header:
// whole facets are counted by the size of the file.
std::size_t check_binary(const InputFile& file, std::vector<std::string>& notices) {
  if (file.size < kPreambleBytes) {
    fail_to_read(file,
                 "{} bytes are too few for an STL file (neither text that begins with 'solid' nor the {} "
                 "bytes that a binary one begins with)",
                 file.size, kPreambleBytes);
  }
  const std::size_t promised = promised_facets(file.data.get());
  const std::size_t held = (file.size - kPreambleBytes) / kFacetBytes;
  const std::size_t needed = kPreambleBytes + promised * kFacetBytes;
  const bool is_whole = file.size == kPreambleBytes + held * kFacetBytes;
  if (!is_whole && promised > 0 && held == promised) {
    notices.push_back(fmt::format("{} after the {} that the STL header promises",
                                  counted(file.size - needed, "byte follows", "bytes follow"),
                                  counted(promised, "triangle", "triangles")));
    return promised;
  }
  if (!is_whole || (held == 0 && promised != 0)) {
    throw InputError(
        fmt::format(
            "{}: the STL header promises {} triangles, which take {} bytes, but the file has {} bytes "
            "({} whole triangles): {}",
            file.name, promised, needed, file.size, held,
            file.size < needed ? "truncated, or not an STL file" : "wrong triangle count"),
        kCopyAgain);
  }
  if (promised != held) {
    notices.push_back(fmt::format("the STL header promises {} triangles, the file holds {}: these are taken",
                                  promised, held));
  }
  if (held > kMostTriangles)
    fail_to_read(file, "{} triangles are more than vertices can be numbered for", held);
  return held;
}

// Reads text STL. Normals are not used, so anything may stand for their numbers; the names of solids may be
// anything to the end of their line.
class TextStlCheck {
 public:
  TextStlCheck(const std::string& name, std::string_view text, std::vector<std::string>& notices)
      : name_(name), text_(text), notices_(notices), rest_(text.substr(start_of_text(text))) {}

  PlainFile run() {
    for (std::string_view token = next_token(); !token.empty(); token = next_token()) read(token);
    if (inside_facet_) fail_truncated();
    if (inside_solid_ && plain_.triangles == 0)
      fail("no triangle follows 'solid' and the name that ends with its line");
    if (inside_solid_) notices_.emplace_back("the STL file does not end with 'endsolid': cut short?");
    plain_.bytes += "endsolid\n";
    return std::move(plain_);
  }

 private:
  void read(std::string_view token) {
    if (token == "vertex") {
      if (!inside_facet_ || ++facet_vertices_ > 3) fail("a vertex that belongs to no triangle");
      read_vertex();
    } else if (token == "facet") {
      if (inside_facet_) fail("a triangle begins before the one before it ends");
      begin_facet();
    } else if (token == "endfacet") {
      if (!inside_facet_ || facet_vertices_ != 3)
        fail(fmt::format("a triangle of {} vertices", facet_vertices_));
      inside_facet_ = false;
    } else if (token == "solid" || token == "endsolid") {
      if (inside_facet_) fail(fmt::format("'{}' inside a triangle", token));
      inside_solid_ = token == "solid";
      is_written_ = false;
      skip_line();
    } else if (is_comment(token) || !(inside_solid_ || inside_facet_)) {
      skip_line();
    } else if (token != "outer" && token != "loop" && token != "endloop") {
      if (rest_.empty()) fail_truncated();
      fail(fmt::format("'{:.20}' is no keyword of STL", token));
    }
  }

  static bool is_comment(std::string_view token) {
    return token.starts_with('#') || token.starts_with(';') || token.starts_with("//");
  }

  void begin_facet() {
    if (next_token() != "normal") {
      if (rest_.empty()) fail_truncated();
      fail("a triangle without its normal");
    }
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view token = next_token();
      if (token.empty()) fail_truncated();
      if (token == "outer" || token == "vertex") fail("a normal of fewer than three numbers");
    }
    if (!is_written_) plain_.bytes += plain_.triangles == 0 ? "solid\n" : "endsolid\nsolid\n";
    is_written_ = true;
    inside_facet_ = true;
    facet_vertices_ = 0;
    ++plain_.triangles;
    plain_.bytes += "facet normal 0 0 0\n";
  }

  void read_vertex() {
    plain_.bytes += "vertex";
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view token = next_token();
      if (rest_.empty()) fail_truncated();
      if (!is_number(token)) fail(fmt::format("'{:.20}' is no number", token));
      (plain_.bytes += ' ') += token;
    }
    plain_.bytes += '\n';
  }

  // In lower case, valid until the next one. Some programs write "end loop".
  std::string_view next_token() {
    token_ = next_word();
    std::transform(token_.begin(), token_.end(), token_.begin(), to_lower_ascii);
    if (token_ == "end") token_ += next_word();
    return token_;
  }

  std::string_view next_word() {
    while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
    std::size_t length = 0;
    while (length < rest_.size() && !is_space(rest_[length])) ++length;
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return word;
  }

  static bool is_space(char c) { return is_blank(c) || c == '\n'; }

  void skip_line() { rest_.remove_prefix(std::min(rest_.find_first_of("\r\n"), rest_.size())); }

  [[noreturn]] void fail_truncated() const {
    fail(
        fmt::format("the file ends before 'endsolid', in or after triangle {}: truncated", plain_.triangles));
  }

  [[noreturn]] void fail(const std::string& what) const {
    const std::string_view read = text_.substr(0, text_.size() - rest_.size());
    throw InputError(
        fmt::format("{}: line {}: {}", name_, 1 + std::count(read.begin(), read.end(), '\n'), what),
        kCopyAgain);
  }

  const std::string& name_;
  std::string_view text_;
  std::vector<std::string>& notices_;
  std::string_view rest_;
  std::string token_;
  PlainFile plain_;
  int facet_vertices_ = 0;
  bool inside_solid_ = false;
  bool inside_facet_ = false;
  bool is_written_ = false;  // the 'solid' that the next triangle belongs to
};

LoadedModel read_text_stl(InputFile& file, std::string_view text, Vec3d factor) {
  std::vector<std::string> notices;
  const PlainFile plain = TextStlCheck(file.name, text, notices).run();
  file.data.reset();
  LoadedModel model = import_with_assimp(file.name, plain, "stl", factor);
  model.notices = std::move(notices);
  return model;
}

// assimp would read a binary file too, but takes some headers for colours or other encodings.
LoadedModel read_stl(InputFile& file, const LoadOptions& options) {
  const Vec3d factor = millimetres_per_unit(options);
  // Some programs fill up the last block of a text file.
  const std::string_view text = file.text().substr(0, file.text().find_last_not_of('\0') + 1);
  if (!is_binary_of_its_size(file) && looks_like_text(text)) return read_text_stl(file, text, factor);
  LoadedModel model;
  const std::size_t count = check_binary(file, model.notices);
  Welder welder(count);
  PartWriter part(welder, Affine::Identity(), factor, file.name);
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, b, c] = corners_of(file.data.get() + kPreambleBytes + i * kFacetBytes);
    part.add_triangle(a, b, c);
  }
  model.mesh = std::move(welder).finish();
  return model;
}

// In fp64, where the cross product of any fp32 edges neither vanishes nor overflows. Some slicers refuse zero
// normals: a triangle without area has (0, 0, 1).
Vec3f unit_normal(Vec3f a, Vec3f b, Vec3f c) {
  const Vec3d origin = to_double(a);
  const Vec3d normal = cross(to_double(b) - origin, to_double(c) - origin);
  const double norm = length(normal);
  if (!(norm > 0)) return {0, 0, 1};
  return to_float(normal * (1 / norm));
}

void write_stl(const Mesh& mesh, OutputFile& file) {
  // A header that begins with "solid" would make readers take the file for ASCII.
  std::string start = "binary STL in millimetres, written by aerate";
  start.resize(kHeaderBytes);
  append_bytes(start, static_cast<std::uint32_t>(mesh.triangles.size()));
  file.write(start);

  write_records(file, mesh.triangles.size(), kFacetBytes, [&](std::size_t i, std::string& out) {
    const Triangle& t = mesh.triangles[i];
    const Vec3f a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    for (const Vec3f vector : {unit_normal(a, b, c), a, b, c}) append_bytes(out, vector);
    append_bytes(out, std::uint16_t{0});
  });
}

Mesh read_written_stl(OwnFile& file) {
  std::array<char, kPreambleBytes> preamble{};
  file.read(preamble.data(), preamble.size());
  const std::size_t count = promised_facets(preamble.data());
  file.require_room_for(count * kFacetBytes);
  Welder welder(count);
  file.for_each_record<kFacetBytes>(count, [&](const char* facet) {
    const auto [a, b, c] = corners_of(facet);
    welder.add_triangle(a, b, c);
  });
  file.require_end();
  return std::move(welder).finish();
}

}  // namespace

constinit const MeshFormat MeshFormat::stl{"STL", ".stl", read_stl, write_stl, read_written_stl};

}  // namespace aerate
