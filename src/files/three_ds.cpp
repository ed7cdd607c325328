#include <algorithm>
#include <cstdint>
#include <string_view>

#include "files/assimp_import.h"
#include "files/formats.h"
#include "files/input_file.h"
#include "files/raw_bytes.h"

namespace aerate {
namespace {

// A file is a tree of chunks: a number that says what it is, its length with these six bytes, its content.
enum Chunk : std::uint16_t {
  whole_file = 0x4d4d,
  scene = 0x3d3d,
  object = 0x4000,  // its name, ended by 0, and chunks
  mesh = 0x4100,
  vertices = 0x4110,  // their number in 16 bits, then three floats each
  faces = 0x4120,     // their number in 16 bits, then three vertices and flags, 16 bits each; then chunks
};
constexpr std::size_t kChunkHeader = 6, kCountBytes = 2, kFaceBytes = 8;

std::string make_chunk(Chunk chunk, const std::string& content) {
  std::string bytes;
  append_bytes(bytes, chunk);
  append_bytes(bytes, static_cast<std::uint32_t>(kChunkHeader + content.size()));
  return bytes + content;
}

// Looks through a file and makes a plain one of it, of meshes alone: assimp would take materials, cameras and
// key frames too. The vertices of a 3DS file stand where they belong, whatever its key frames say.
class ThreeDsCheck {
 public:
  explicit ThreeDsCheck(const InputFile& file) : file_(file) {}

  PlainFile run() {
    if (file_.size > kMostBytes) fail_to_read(file_, "more than {} bytes", kMostBytes);
    walk(file_.text(), [&](std::uint16_t chunk, std::string_view content) {
      if (chunk == whole_file) read_scenes(content);
    });
    return {make_chunk(whole_file, make_chunk(scene, objects_)), triangle_count_};
  }

 private:
  // Calls f(chunk, content) for each of the chunks that `bytes` consists of.
  template <typename F>
  void walk(std::string_view bytes, const F& f) const {
    while (!bytes.empty()) {
      if (bytes.size() < kChunkHeader)
        fail_to_read(file_, "ends within a chunk: truncated, or not a 3DS file");
      const std::size_t length = value_at<std::uint32_t>(bytes.data() + 2);
      if (length < kChunkHeader || length > bytes.size()) {
        fail_to_read(file_, "a chunk of {} bytes where {} are left: truncated, or not a 3DS file", length,
                     bytes.size());
      }
      f(value_at<std::uint16_t>(bytes.data()), bytes.substr(kChunkHeader, length - kChunkHeader));
      bytes.remove_prefix(length);
    }
  }

  void read_scenes(std::string_view content) {
    walk(content, [&](std::uint16_t chunk, std::string_view scene_content) {
      if (chunk != scene) return;
      walk(scene_content, [&](std::uint16_t inner, std::string_view named) {
        if (inner == object) read_object(named);
      });
    });
  }

  void read_object(std::string_view named) {
    const std::size_t end = named.find('\0');
    if (end == std::string_view::npos) fail_to_read(file_, "an object's name does not end");
    walk(named.substr(end + 1), [&](std::uint16_t chunk, std::string_view content) {
      if (chunk == mesh) read_mesh(content);
    });
  }

  void read_mesh(std::string_view content) {
    std::string_view corners, triangles;
    walk(content, [&](std::uint16_t chunk, std::string_view values) {
      if (chunk == vertices) corners = take_counted(values, sizeof(Vec3f));
      if (chunk == faces) triangles = take_counted(values, kFaceBytes);
    });
    const std::size_t vertex_count = corners.empty() ? 0 : value_at<std::uint16_t>(corners.data());
    const std::size_t count = triangles.empty() ? 0 : value_at<std::uint16_t>(triangles.data());
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto index = value_at<std::uint16_t>(triangles.data() + kCountBytes + i * kFaceBytes +
                                                   corner * sizeof(std::uint16_t));
        if (index >= vertex_count)
          fail_to_read(file_, "vertex {} of a triangle is out of range (its object has {})", index,
                       vertex_count);
      }
    }
    if (count == 0) return;
    triangle_count_ += count;
    objects_ += make_chunk(
        object, std::string(1, '\0') + make_chunk(mesh, make_chunk(vertices, std::string(corners)) +
                                                            make_chunk(faces, std::string(triangles))));
  }

  // A count and so many records.
  std::string_view take_counted(std::string_view values, std::size_t record) const {
    const std::size_t count = values.size() < kCountBytes ? 0 : value_at<std::uint16_t>(values.data());
    if (values.size() < kCountBytes + count * record)
      fail_to_read(file_, "a chunk promises {} records and is shorter: truncated?", count);
    return values.substr(0, kCountBytes + count * record);
  }

  const InputFile& file_;
  std::string objects_;
  std::size_t triangle_count_ = 0;
};

LoadedModel read_3ds(InputFile& file, const LoadOptions& options) {
  // assimp turns the z axis of a 3DS file to y.
  Affine turned_back = Affine::Identity();
  turned_back.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return import_with_assimp(file.name, ThreeDsCheck(file).run(), "3ds", millimetres_per_unit(options),
                            turned_back);
}

}  // namespace

constinit const MeshFormat MeshFormat::three_ds{"3DS", ".3ds", read_3ds};

}  // namespace aerate
