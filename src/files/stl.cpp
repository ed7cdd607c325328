#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "files/assimp_import.h"
#include "files/formats.h"
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
  const std::size_t start =
      text.find_first_not_of(" \t\r\n", text.starts_with(kUtf8Mark) ? kUtf8Mark.size() : 0);
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

std::size_t check_binary(const InputFile& file) {
  if (file.size < kPreambleBytes) {
    fail_to_read(file,
                 "{} bytes are too few for an STL file (neither text that begins with 'solid' nor the {} "
                 "bytes that a binary one begins with)",
                 file.size, kPreambleBytes);
  }
  const std::size_t promised = promised_facets(file.data.get());
  if (!is_binary_of_its_size(file)) {
    const std::size_t needed = kPreambleBytes + promised * kFacetBytes;
    throw InputError(
        fmt::format(
            "{}: the STL header promises {} triangles, which take {} bytes, but the file has {} bytes "
            "({} whole triangles): {}",
            file.name, promised, needed, file.size, (file.size - kPreambleBytes) / kFacetBytes,
            file.size < needed ? "truncated, or not an STL file" : "wrong triangle count"),
        kCopyAgain);
  }
  if (promised > kMostTriangles)
    fail_to_read(file, "{} triangles are more than vertices can be numbered for", promised);
  return promised;
}

// Reads the keywords of a text STL file; makes it lower case and blanks the names of its solids, which may
// hold anything, so that the importer sees keywords and numbers only.
class TextStlCheck {
 public:
  explicit TextStlCheck(InputFile& file) : file_(file), cursor_(file.data.get()), end_(cursor_ + file.size) {
    if (file.text().starts_with(kUtf8Mark)) std::fill_n(cursor_, kUtf8Mark.size(), ' ');
  }

  std::size_t count_facets() {
    for (std::string_view token = next_token(); !token.empty(); token = next_token()) read(token);
    if (inside_solid_) fail_truncated();
    return facets_;
  }

 private:
  void read(std::string_view token) {
    if (token == "vertex") {
      if (!inside_facet_ || ++facet_vertices_ > 3) fail("a vertex that belongs to no triangle");
    } else if (token == "facet") {
      if (inside_facet_) fail("a triangle begins before the one before it ends");
      inside_facet_ = true;
      facet_vertices_ = 0;
      ++facets_;
    } else if (token == "endfacet") {
      if (!inside_facet_ || facet_vertices_ != 3)
        fail(fmt::format("a triangle of {} vertices", facet_vertices_));
      inside_facet_ = false;
    } else if (token == "solid") {
      if (inside_solid_) fail("'solid' before the 'endsolid' of the one before it");
      inside_solid_ = true;
      blank_line();
    } else if (token == "endsolid") {
      if (inside_facet_) fail("'endsolid' inside a triangle");
      inside_solid_ = false;
      blank_line();
    } else if (!is_filler(token)) {
      if (cursor_ == end_) fail_truncated();
      fail(fmt::format("'{:.20}' is no keyword of STL", token));
    }
  }

  // Numbers are the importer's to read.
  static bool is_filler(std::string_view token) {
    const bool number = token.find_first_of("0123456789") != std::string_view::npos ||
                        token.find("nan") != std::string_view::npos ||
                        token.find("inf") != std::string_view::npos;
    return number || token == "outer" || token == "loop" || token == "endloop" || token == "normal";
  }

  std::string_view next_token() {
    while (cursor_ != end_ && (is_blank(*cursor_) || *cursor_ == '\n')) ++cursor_;
    const char* const token = cursor_;
    while (cursor_ != end_ && !is_blank(*cursor_) && *cursor_ != '\n') {
      *cursor_ = to_lower_ascii(*cursor_);
      ++cursor_;
    }
    return {token, static_cast<std::size_t>(cursor_ - token)};
  }

  void blank_line() {
    while (cursor_ != end_ && *cursor_ != '\n' && *cursor_ != '\r') *cursor_++ = ' ';
  }

  [[noreturn]] void fail_truncated() const {
    fail(fmt::format("the file ends before 'endsolid', in or after triangle {}: truncated", facets_));
  }

  [[noreturn]] void fail(const std::string& what) const {
    const auto line = 1 + std::count(file_.data.get(), cursor_, '\n');
    throw InputError(fmt::format("{}: line {}: {}", file_.name, line, what), kCopyAgain);
  }

  const InputFile& file_;
  char* cursor_;
  char* end_;
  std::size_t facets_ = 0;
  int facet_vertices_ = 0;
  bool inside_solid_ = false;
  bool inside_facet_ = false;
};

// assimp would read a binary file too, but takes some headers for colours or other encodings.
LoadedModel read_stl(InputFile& file, const LoadOptions& options) {
  const double factor = millimetres_per_unit(options);
  if (!is_binary_of_its_size(file) && looks_like_text(file.text()))
    return import_with_assimp(file, "stl", TextStlCheck(file).count_facets(), factor);
  const std::size_t count = check_binary(file);
  Welder welder(count);
  PartWriter part(welder, Affine::Identity(), factor, file.name);
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, b, c] = corners_of(file.data.get() + kPreambleBytes + i * kFacetBytes);
    part.add_triangle(a, b, c);
  }
  return {.mesh = std::move(welder).finish(), .format = {}};
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
