#include "files/formats.h"

#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <vector>

#include "core/error.h"
#include "core/listed.h"
#include "files/own_file.h"
#include "files/text_scan.h"

namespace aerate {
namespace {

const MeshFormat* format_of(const std::string& ending) {
  for (const MeshFormat* format : kMeshFormats) {
    if (ending == format->ending) return format;
  }
  return nullptr;
}

}  // namespace

std::string names_that_are_read() {
  std::vector<std::string> names;
  names.reserve(std::size(kMeshFormats));
  for (const MeshFormat* format : kMeshFormats) names.emplace_back(format->name);
  return listed(names, "or");
}

std::string endings_that_are_written() {
  std::vector<std::string> endings;
  for (const MeshFormat* format : kMeshFormats) {
    if (format->write != nullptr) endings.emplace_back(format->ending);
  }
  return listed(endings, "or");
}

bool is_a_models_name(const std::filesystem::path& path) {
  return format_of(ending_of(path)) != nullptr;
}

const MeshFormat& format_to_read(const std::filesystem::path& path) {
  const std::string ending = ending_of(path);
  if (const MeshFormat* const format = format_of(ending)) return *format;
  throw InputError(ending.empty()
                       ? fmt::format("{}: the name has no ending that says what it is", path.string())
                       : fmt::format("{}: '{}' is not a format that can be read", path.string(), ending),
                   fmt::format("use {}", names_that_are_read()));
}

const MeshFormat* find_format_to_write(const std::filesystem::path& path) {
  const MeshFormat* const format = format_of(ending_of(path));
  return format != nullptr && format->write != nullptr ? format : nullptr;
}

const MeshFormat& format_to_write(const std::filesystem::path& path) {
  if (const MeshFormat* const format = find_format_to_write(path)) return *format;
  const std::string ending = ending_of(path);
  throw UsageError(
      fmt::format("{}: cannot write {}", path.string(), ending.empty() ? "a file without an ending" : ending),
      fmt::format("use a name that ends in {}", endings_that_are_written()));
}

void write_mesh(const Mesh& mesh, const Destination& destination, const MeshFormat& format) {
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max() ||
      mesh.positions.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw FailureError(fmt::format("{}: {} triangles are more than the format can count",
                                   destination.shown.string(), mesh.triangles.size()),
                       "raise --tolerance");
  }
  OutputFile file(destination);
  format.write(mesh, file);
  file.close();
}

Mesh read_back(const std::filesystem::path& path, const MeshFormat& format, Monitor& monitor) {
  OwnFile file(path, monitor);
  return format.read_back(file);
}

}  // namespace aerate
