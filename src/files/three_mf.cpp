#include "files/three_mf.h"

#include <fmt/compile.h>
#include <iterator>
#include <memory>
#include <span>
#include <zip.h>

#include "files/decimal.h"

namespace aerate {
namespace {

// Speed matters more than a tenth of the size.
constexpr zip_uint32_t kDeflateLevel = 3;

[[noreturn]] void fail_to_zip(const std::string& why) {
  throw FailureError("the 3MF package cannot be made: " + why);
}

// A zip archive in memory.
class ZipWriter {
 public:
  ZipWriter() {
    zip_error_t error;
    zip_error_init(&error);
    buffer_ = zip_source_buffer_create(nullptr, 0, 0, &error);
    if (buffer_ == nullptr) fail_to_zip(zip_error_strerror(&error));
    zip_source_keep(buffer_);
    archive_ = zip_open_from_source(buffer_, ZIP_TRUNCATE, &error);
    if (archive_ == nullptr) fail_to_zip(zip_error_strerror(&error));
    zip_error_fini(&error);
  }
  ~ZipWriter() {
    if (archive_ != nullptr) zip_discard(archive_);
    zip_source_free(buffer_);
  }
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  // `content` has to stay until `finish`.
  void add(const std::string& name, const std::string& content) {
    constexpr zip_uint16_t kNoon = 12 << 11;  // as MS-DOS counts
    constexpr zip_uint16_t kFirstOfJanuary1980 = 1 << 5 | 1;
    zip_source_t* source = zip_source_buffer(archive_, content.data(), content.size(), 0);
    const zip_int64_t added =
        source == nullptr ? -1 : zip_file_add(archive_, name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (added < 0) fail_to_zip(zip_strerror(archive_));
    const auto index = static_cast<zip_uint64_t>(added);
    if (zip_set_file_compression(archive_, index, ZIP_CM_DEFLATE, kDeflateLevel) != 0 ||
        zip_file_set_dostime(archive_, index, kNoon, kFirstOfJanuary1980, 0) != 0)
      fail_to_zip(zip_strerror(archive_));
  }

  std::string finish() {
    if (zip_close(archive_) != 0) fail_to_zip(zip_strerror(archive_));
    archive_ = nullptr;
    zip_stat_t facts;
    zip_stat_init(&facts);
    if (zip_source_stat(buffer_, &facts) != 0 || zip_source_open(buffer_) != 0)
      fail_to_zip("lost its buffer");
    std::string bytes(facts.size, '\0');
    const zip_int64_t count = zip_source_read(buffer_, bytes.data(), bytes.size());
    zip_source_close(buffer_);
    if (count < 0 || static_cast<std::size_t>(count) != bytes.size()) fail_to_zip("lost part of its buffer");
    return bytes;
  }

 private:
  zip_source_t* buffer_ = nullptr;
  zip_t* archive_ = nullptr;
};

void append_vertex(std::string& out, Vec3f position) {
  fmt::format_to(std::back_inserter(out), FMT_COMPILE("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n"),
                 Decimal{position.x}, Decimal{position.y}, Decimal{position.z});
}

void append_triangle(std::string& out, const Triangle& triangle) {
  fmt::format_to(std::back_inserter(out), FMT_COMPILE("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>\n"),
                 triangle[0], triangle[1], triangle[2]);
}

// Rows are written as text: a document of a million triangles takes a third of a gigabyte.
void append_mesh(std::string& out, std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
  constexpr std::size_t kVertexBytes = 56, kTriangleBytes = 46;
  out.reserve(out.size() + positions.size() * kVertexBytes + triangles.size() * kTriangleBytes);
  out += "<mesh>\n<vertices>\n";
  for (const Vec3f position : positions) append_vertex(out, position);
  out += "</vertices>\n<triangles>\n";
  for (const Triangle& triangle : triangles) append_triangle(out, triangle);
  out += "</triangles>\n</mesh>\n";
}

void begin_object(std::string& out, std::size_t id, std::string_view name = {}) {
  out += fmt::format("<object id=\"{}\" type=\"model\"", id);
  if (!name.empty()) out += fmt::format(" name=\"{}\"", xml_value(name));
  out += ">\n";
}

void append_mesh_object(std::string& out, std::size_t id, const Mesh& mesh, std::string_view name = {},
                        std::string_view notes = {}) {
  begin_object(out, id, name);
  out += notes;
  append_mesh(out, mesh.positions, mesh.triangles);
  out += "</object>\n";
}

// The object of components and what it consists of; its id.
std::size_t append_components(std::string& out, const Mesh& mesh, const ThreeMfExtras& extras) {
  std::size_t first = 0, id = 0;
  for (const std::size_t count : extras.component_triangles) {
    const std::string_view notes = id < extras.component_notes.size()
                                       ? std::string_view(extras.component_notes[id])
                                       : std::string_view();
    append_mesh_object(out, ++id, submesh(mesh, std::span(mesh.triangles).subspan(first, count)), {}, notes);
    first += count;
  }
  const std::size_t object = id + 1;
  begin_object(out, object, extras.object_name);
  out += "<components>\n";
  for (id = 1; id < object; ++id) out += fmt::format("<component objectid=\"{}\"/>\n", id);
  out += "</components>\n</object>\n";
  return object;
}

std::string model_document(const Mesh& mesh, const ThreeMfExtras& extras) {
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" "
      "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"" +
      (extras.namespaces.empty() ? "" : " " + extras.namespaces) +
      ">\n"
      "<metadata name=\"Application\">" +
      extras.application + "</metadata>\n<resources>\n";
  std::size_t object = 1;
  if (extras.component_triangles.empty()) {
    append_mesh_object(out, object, mesh, extras.object_name);
  } else {
    object = append_components(out, mesh, extras);
  }
  out += fmt::format("</resources>\n<build>\n<item objectid=\"{}\"/>\n</build>\n</model>\n", object);
  return out;
}

}  // namespace

std::string xml_value(std::string_view text) {
  std::string value;
  for (const char c : text) {
    switch (c) {
      case '&':
        value += "&amp;";
        break;
      case '<':
        value += "&lt;";
        break;
      case '>':
        value += "&gt;";
        break;
      case '"':
        value += "&quot;";
        break;
      default:
        value += c;
    }
  }
  return value;
}

std::string to_3mf(const Mesh& mesh, const ThreeMfExtras& extras) {
  const std::string types =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n"
      "<Default Extension=\"rels\" "
      "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n"
      "<Default Extension=\"model\" "
      "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n"
      "<Default Extension=\"config\" ContentType=\"text/xml\"/>\n</Types>\n";
  const std::string relations =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n"
      "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel-1\" "
      "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n</Relationships>\n";
  const std::string model = model_document(mesh, extras);
  ZipWriter zip;
  zip.add("[Content_Types].xml", types);
  zip.add("_rels/.rels", relations);
  zip.add(kThreeMfModel, model);
  for (const ThreeMfEntry& entry : extras.entries) zip.add(entry.name, entry.content);
  return zip.finish();
}

FailureError not_as_written(const std::filesystem::path& path, const std::string& why) {
  return FailureError(path.string() + ": is not the 3MF package that was written: " + why);
}

std::string read_3mf_entry(const std::filesystem::path& path, const std::string& name) {
  const auto close = [](zip_t* archive) { zip_discard(archive); };
  int code = 0;
  const std::unique_ptr<zip_t, decltype(close)> archive(
      zip_open(path.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &code), close);
  if (!archive) throw not_as_written(path, "not a zip archive");
  zip_stat_t facts;
  zip_stat_init(&facts);
  if (zip_stat(archive.get(), name.c_str(), 0, &facts) != 0) throw not_as_written(path, name + " is missing");
  // Deflate makes a thousandth of zeros at the very best.
  constexpr zip_uint64_t kMostPerByte = 1100;
  if (facts.size / kMostPerByte > facts.comp_size)
    throw not_as_written(path, name + " cannot be as long as it says");
  std::string content(facts.size, '\0');
  zip_file_t* file = zip_fopen_index(archive.get(), facts.index, 0);
  if (file == nullptr) throw not_as_written(path, name + " cannot be opened");
  const zip_int64_t count = zip_fread(file, content.data(), content.size());
  zip_fclose(file);
  if (count < 0 || static_cast<std::size_t>(count) != content.size())
    throw not_as_written(path, name + " is cut off");
  return content;
}

}  // namespace aerate
