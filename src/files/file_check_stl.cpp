#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <string_view>
#include <system_error>

#include "core/error.h"
#include "files/file_check.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kFacetBytes = 50;
constexpr std::size_t kMaxFacets = std::numeric_limits<std::uint32_t>::max() / 3;  // corners are numbered
constexpr std::size_t kPreambleBytes = kHeaderBytes + sizeof(std::uint32_t);

// Some editors put it before text.
constexpr std::string_view kUtf8Mark = "\xef\xbb\xbf";

std::uint32_t promised_facets(const char* preamble) {
  std::uint32_t count = 0;  // little-endian, as the machines this builds for
  std::memcpy(&count, preamble + kHeaderBytes, sizeof(count));
  return count;
}

// Both kinds may begin with "solid"; binary data has zero bytes early on, text has none.
bool looks_like_text_stl(std::string_view text) {
  constexpr std::string_view kKeyword = "solid";
  const std::size_t start =
      text.find_first_not_of(" \t\r\n", text.starts_with(kUtf8Mark) ? kUtf8Mark.size() : 0);
  if (start == std::string_view::npos || text.size() - start < kKeyword.size()) return false;
  for (std::size_t i = 0; i < kKeyword.size(); ++i) {
    if (to_lower_ascii(text[start + i]) != kKeyword[i]) return false;
  }
  return text.substr(0, 1024).find('\0') == std::string_view::npos;
}

FileFacts check_binary(FileBytes& bytes, const std::string& name) {
  if (bytes.size < kPreambleBytes) {
    throw InputError(
        fmt::format("{}: {} bytes are too few for an STL file (neither text that begins with 'solid' "
                    "nor the {} bytes that a binary one begins with)",
                    name, bytes.size, kPreambleBytes));
  }
  const std::size_t promised = promised_facets(bytes.data.get());
  const std::size_t needed = kPreambleBytes + promised * kFacetBytes;
  if (bytes.size != needed) {
    const std::size_t held = (bytes.size - kPreambleBytes) / kFacetBytes;
    throw InputError(
        fmt::format(
            "{}: the STL header promises {} triangles, which take {} bytes, but the file has {} bytes "
            "({} whole triangles): {}",
            name, promised, needed, bytes.size, held,
            bytes.size < needed ? "truncated, or not an STL file" : "wrong triangle count"),
        "export or copy the file again");
  }
  if (promised == 0) throw InputError(fmt::format("{}: no triangles", name));
  if (promised > kMaxFacets) {
    throw InputError(
        fmt::format("{}: {} triangles are more than vertices can be numbered for", name, promised));
  }
  // The header says nothing about the shape, but the importer looks into it for colours and byte-order marks.
  std::memset(bytes.data.get(), 0, kHeaderBytes);
  return {.face_count = promised, .vertex_count = std::nullopt};
}

// Reads the keywords of a text STL file; makes it lower case and blanks the names of its solids, which may
// hold anything, so that the importer sees keywords and numbers only.
class TextStlCheck {
 public:
  TextStlCheck(FileBytes& bytes, const std::string& name)
      : begin_(bytes.data.get()), cursor_(begin_), end_(begin_ + bytes.size), name_(name) {
    if (bytes.text().starts_with(kUtf8Mark)) std::fill_n(begin_, kUtf8Mark.size(), ' ');
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
    std::size_t line = 1;
    for (const char* c = begin_; c != cursor_; ++c) line += *c == '\n' ? 1 : 0;
    throw InputError(fmt::format("{}: line {}: {}", name_, line, what), "export or copy the file again");
  }

  char* begin_;
  char* cursor_;
  char* end_;
  const std::string& name_;
  std::size_t facets_ = 0;
  int facet_vertices_ = 0;
  bool inside_solid_ = false;
  bool inside_facet_ = false;
};

}  // namespace

std::optional<FileFacts> check_binary_stl(const std::filesystem::path& path) {
  std::array<char, kPreambleBytes> preamble{};
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file.read(preamble.data(), preamble.size())) return std::nullopt;
  const std::size_t promised = promised_facets(preamble.data());
  if (promised == 0 || promised > kMaxFacets || size != kPreambleBytes + promised * kFacetBytes)
    return std::nullopt;
  // The importer takes some first bytes for a byte-order mark, and converts the file.
  if (preamble[0] < ' ' && preamble[0] != 0) return std::nullopt;
  return FileFacts{.face_count = promised, .vertex_count = std::nullopt};
}

FileFacts check_stl(FileBytes& bytes, const std::string& name) {
  const bool binary = bytes.size >= kPreambleBytes &&
                      bytes.size == kPreambleBytes + promised_facets(bytes.data.get()) * kFacetBytes;
  if (binary || !looks_like_text_stl(bytes.text())) return check_binary(bytes, name);
  return {.face_count = TextStlCheck(bytes, name).count_facets(), .vertex_count = std::nullopt};
}

}  // namespace aerate
