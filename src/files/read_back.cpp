#include "files/read_back.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "files/load.h"
#include "files/weld.h"

namespace aerate {
namespace {

// Records, or lines of text, between two questions to the monitor.
constexpr std::size_t kRecordsPerBlock = std::size_t{1} << 16;

[[noreturn]] void fail(const std::filesystem::path& path, std::string_view why) {
  throw FailureError(fmt::format("{}: the file on disk is not what was written: {}", path.string(), why));
}

template <typename T>
T value_at(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

// A binary file from its front to its end.
class BinaryFile {
 public:
  BinaryFile(const std::filesystem::path& path, Monitor& monitor)
      : path_(path), monitor_(monitor), stream_(path, std::ios::binary) {}

  void read(char* bytes, std::size_t count) {
    if (!stream_.read(bytes, static_cast<std::streamsize>(count))) fail(path_, "it ends too early");
  }

  // Before memory is taken by a count that the file gives.
  void require_room_for(std::size_t bytes) {
    const auto size = std::filesystem::file_size(path_);
    if (size - static_cast<std::size_t>(stream_.tellg()) < bytes) fail(path_, "it ends too early");
  }

  // Calls f(bytes of a record) for each of `count` records.
  template <std::size_t kRecordBytes, typename F>
  void for_each_record(std::size_t count, const F& f) {
    std::vector<char> block(std::min(count, kRecordsPerBlock) * kRecordBytes);
    for (std::size_t first = 0; first < count; first += kRecordsPerBlock) {
      monitor_.check_interrupted();
      const std::size_t records = std::min(kRecordsPerBlock, count - first);
      read(block.data(), records * kRecordBytes);
      for (std::size_t i = 0; i < records; ++i) f(block.data() + i * kRecordBytes);
    }
  }

  std::string line() {
    std::string text;
    if (!std::getline(stream_, text)) fail(path_, "its header ends too early");
    return text;
  }

  void require_end() {
    if (stream_.peek() != std::ifstream::traits_type::eof()) fail(path_, "something follows after its end");
  }

 private:
  const std::filesystem::path& path_;
  Monitor& monitor_;
  std::ifstream stream_;
};

Mesh read_written_stl(const std::filesystem::path& path, Monitor& monitor) {
  constexpr std::size_t kHeaderBytes = 80, kNormalBytes = 12, kFacetBytes = 50;
  BinaryFile file(path, monitor);
  std::array<char, kHeaderBytes + sizeof(std::uint32_t)> preamble{};
  file.read(preamble.data(), preamble.size());
  const auto count = value_at<std::uint32_t>(preamble.data() + kHeaderBytes);
  file.require_room_for(count * kFacetBytes);
  Welder welder(count);
  file.for_each_record<kFacetBytes>(count, [&](const char* facet) {
    const auto corners = value_at<std::array<Vec3f, 3>>(facet + kNormalBytes);
    welder.add_triangle(corners[0], corners[1], corners[2]);
  });
  file.require_end();
  return std::move(welder).finish();
}

// The number in a header line "element NAME number".
std::size_t count_in(const std::filesystem::path& path, std::string_view line, std::string_view name) {
  const std::string start = fmt::format("element {} ", name);
  std::size_t count = 0;
  const auto [end, error] =
      std::from_chars(line.data() + std::min(line.size(), start.size()), line.data() + line.size(), count);
  if (!line.starts_with(start) || error != std::errc() || end != line.data() + line.size())
    fail(path, fmt::format("'{}' instead of the number of its elements '{}'", line, name));
  return count;
}

Mesh read_written_ply(const std::filesystem::path& path, Monitor& monitor) {
  constexpr std::size_t kFaceBytes = 1 + sizeof(Triangle);
  BinaryFile file(path, monitor);
  std::size_t vertex_count = 0, face_count = 0;
  for (std::string line = file.line(); line != "end_header"; line = file.line()) {
    if (line.starts_with("element v")) vertex_count = count_in(path, line, "vertex");
    if (line.starts_with("element f")) face_count = count_in(path, line, "face");
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
    if (*face != 3 || !exist) fail(path, "a face is no triangle of its vertices");
    welder.add_triangle(positions[corners[0]], positions[corners[1]], positions[corners[2]]);
  });
  file.require_end();
  return std::move(welder).finish();
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

Mesh read_written_obj(const std::filesystem::path& path, Monitor& monitor) {
  std::ifstream file(path);
  std::vector<Vec3f> positions;
  Welder welder(0);
  std::size_t line_number = 0;
  for (std::string line; std::getline(file, line);) {
    if (++line_number % kRecordsPerBlock == 0) monitor.check_interrupted();
    std::array<float, 3> p{};
    std::array<std::uint32_t, 3> corners{};
    if (line.starts_with('v') && scan_three(std::string_view(line).substr(1), p)) {
      positions.push_back({p[0], p[1], p[2]});
    } else if (line.starts_with('f') && scan_three(std::string_view(line).substr(1), corners)) {
      for (const std::uint32_t corner : corners) {
        if (corner == 0 || corner > positions.size())
          fail(path, fmt::format("line {} names a vertex that is not there", line_number));
      }
      welder.add_triangle(positions[corners[0] - 1], positions[corners[1] - 1], positions[corners[2] - 1]);
    } else if (!line.empty() && !line.starts_with('#')) {
      fail(path, fmt::format("line {}", line_number));
    }
  }
  return std::move(welder).finish();
}

}  // namespace

Mesh read_back(const std::filesystem::path& path, MeshFormat format, Monitor& monitor) {
  switch (format) {
    case MeshFormat::stl:
      return read_written_stl(path, monitor);
    case MeshFormat::ply:
      return read_written_ply(path, monitor);
    case MeshFormat::obj:
      return read_written_obj(path, monitor);
    case MeshFormat::three_mf:
      monitor.check_interrupted();
      return load_model(path, {.unit = {}, .other_volumes = OtherVolumes::take_as_bodies}).mesh;
  }
  fail(path, "no reader for this format");
}

}  // namespace aerate
