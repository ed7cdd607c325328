#include "files/three_mf.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <memory>
#include <pugixml.hpp>
#include <span>
#include <sstream>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <zip.h>

#include "core/error.h"
#include "files/decimal.h"

namespace aerate {
namespace {

constexpr const char* kModelFile = "3D/3dmodel.model";
constexpr const char* kPrusaConfig = "Metadata/Slic3r_PE_model.config";
constexpr const char* kOrcaConfig = "Metadata/model_settings.config";

// What Orca and Bambu Studio look for before they read settings of parts from a package.
constexpr const char* kOrcaApplication = "BambuStudio-01.08.00.00";
constexpr const char* kIdentity = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";

// Speed matters more than a tenth of the size.
constexpr zip_uint32_t kDeflateLevel = 3;

const char* config_file_of(ThreeMfFlavor flavor) {
  return flavor == ThreeMfFlavor::prusa ? kPrusaConfig : kOrcaConfig;
}

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
  void add(const char* name, const std::string& content) {
    constexpr zip_uint16_t kNoon = 12 << 11;  // as MS-DOS counts
    constexpr zip_uint16_t kFirstOfJanuary1980 = 1 << 5 | 1;
    zip_source_t* source = zip_source_buffer(archive_, content.data(), content.size(), 0);
    const zip_int64_t added = source == nullptr ? -1 : zip_file_add(archive_, name, source, ZIP_FL_ENC_UTF_8);
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

std::string text_of(const pugi::xml_document& document) {
  std::ostringstream stream;
  document.save(stream, " ", pugi::format_default, pugi::encoding_utf8);
  return std::move(stream).str();
}

std::string percent(double value) {
  char digits[32];
  return std::string(digits, std::to_chars(digits, digits + sizeof digits, value).ptr) + "%";
}

void add_metadata(pugi::xml_node node, const char* type, const char* key, const std::string& value) {
  pugi::xml_node metadata = node.append_child("metadata");
  if (type != nullptr) metadata.append_attribute("type") = type;
  metadata.append_attribute("key") = key;
  metadata.append_attribute("value") = value.c_str();
}

// Object ids: a part's mesh has its number from 1; the object that is printed is the only mesh, or comes
// after the parts that it is made of.
std::size_t object_id(std::size_t part_count, ThreeMfFlavor flavor) {
  return flavor == ThreeMfFlavor::prusa ? 1 : part_count + 1;
}

std::string prusa_config(const std::vector<ThreeMfPart>& parts) {
  pugi::xml_document document;
  pugi::xml_node object = document.append_child("config").append_child("object");
  object.append_attribute("id") = object_id(parts.size(), ThreeMfFlavor::prusa);
  object.append_attribute("instances_count") = 1;
  add_metadata(object, "object", "name", parts.front().name);
  for (const ThreeMfPart& part : parts) {
    pugi::xml_node volume = object.append_child("volume");
    volume.append_attribute("firstid") = part.first_triangle;
    volume.append_attribute("lastid") = part.first_triangle + part.triangle_count - 1;
    add_metadata(volume, "volume", "name", part.name);
    add_metadata(volume, "volume", "volume_type", part.infill_percent ? "ParameterModifier" : "ModelPart");
    if (!part.infill_percent) continue;
    add_metadata(volume, "volume", "modifier", "1");  // how versions before 2.3 put it
    add_metadata(volume, "volume", "fill_density", percent(*part.infill_percent));
  }
  return text_of(document);
}

std::string orca_config(const std::vector<ThreeMfPart>& parts) {
  pugi::xml_document document;
  pugi::xml_node object = document.append_child("config").append_child("object");
  object.append_attribute("id") = object_id(parts.size(), ThreeMfFlavor::orca);
  add_metadata(object, nullptr, "name", parts.front().name);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    pugi::xml_node part = object.append_child("part");
    part.append_attribute("id") = i + 1;
    part.append_attribute("subtype") = parts[i].infill_percent ? "modifier_part" : "normal_part";
    add_metadata(part, nullptr, "name", parts[i].name);
    add_metadata(part, nullptr, "matrix", kIdentity);
    if (parts[i].infill_percent)
      add_metadata(part, nullptr, "sparse_infill_density", percent(*parts[i].infill_percent));
  }
  return text_of(document);
}

void append_vertex(std::string& out, Vec3f position) {
  out += "<vertex x=\"";
  append_coordinate(out, position.x);
  out += "\" y=\"";
  append_coordinate(out, position.y);
  out += "\" z=\"";
  append_coordinate(out, position.z);
  out += "\"/>\n";
}

void append_triangle(std::string& out, const Triangle& triangle) {
  out += "<triangle v1=\"";
  append_index(out, triangle[0]);
  out += "\" v2=\"";
  append_index(out, triangle[1]);
  out += "\" v3=\"";
  append_index(out, triangle[2]);
  out += "\"/>\n";
}

bool names_a_vertex_twice(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

// Rows are written as text: a document of a million triangles takes a third of a gigabyte.
void append_mesh(std::string& out, std::span<const Vec3f> positions, std::span<const Triangle> triangles) {
  constexpr std::size_t kVertexBytes = 56, kTriangleBytes = 46;
  out.reserve(out.size() + positions.size() * kVertexBytes + triangles.size() * kTriangleBytes);
  auto vertex_count = static_cast<std::uint32_t>(positions.size());
  out += "<mesh>\n<vertices>\n";
  for (const Vec3f position : positions) append_vertex(out, position);
  for (const Triangle& t : triangles) {
    if (!names_a_vertex_twice(t)) continue;
    for (const std::uint32_t vertex : t) append_vertex(out, positions[vertex]);
  }
  out += "</vertices>\n<triangles>\n";
  for (const Triangle& t : triangles) {
    if (names_a_vertex_twice(t)) {
      append_triangle(out, {vertex_count, vertex_count + 1, vertex_count + 2});
      vertex_count += 3;
    } else {
      append_triangle(out, t);
    }
  }
  out += "</triangles>\n</mesh>\n";
}

// The triangles of a part with only the vertices they use, in order of first use.
Mesh part_of(const Mesh& mesh, const ThreeMfPart& part) {
  Mesh own;
  own.triangles.reserve(part.triangle_count);
  std::unordered_map<std::uint32_t, std::uint32_t> numbers;
  for (std::size_t i = part.first_triangle; i < part.first_triangle + part.triangle_count; ++i) {
    Triangle triangle = mesh.triangles[i];
    for (std::uint32_t& vertex : triangle) {
      const auto next = static_cast<std::uint32_t>(own.positions.size());
      const auto [at, is_new] = numbers.try_emplace(vertex, next);
      if (is_new) own.positions.push_back(mesh.positions[vertex]);
      vertex = at->second;
    }
    own.triangles.push_back(triangle);
  }
  return own;
}

std::string model_head(const char* application) {
  return std::string(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" "
             "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
             "<metadata name=\"Application\">") +
         application + "</metadata>\n<resources>\n";
}

void append_tail(std::string& out, std::size_t object) {
  out += "</resources>\n<build>\n<item objectid=\"" + std::to_string(object) + "\"/>\n</build>\n</model>\n";
}

std::string single_mesh_model(const Mesh& mesh) {
  std::string out = model_head("aerate");
  out += "<object id=\"1\" type=\"model\">\n";
  append_mesh(out, mesh.positions, mesh.triangles);
  out += "</object>\n";
  append_tail(out, 1);
  return out;
}

std::string component_model(const Mesh& mesh, const std::vector<ThreeMfPart>& parts) {
  std::string out = model_head(kOrcaApplication);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Mesh part = part_of(mesh, parts[i]);
    out += "<object id=\"" + std::to_string(i + 1) + "\" type=\"model\">\n";
    append_mesh(out, part.positions, part.triangles);
    out += "</object>\n";
  }
  const std::size_t object = object_id(parts.size(), ThreeMfFlavor::orca);
  out += "<object id=\"" + std::to_string(object) + "\" type=\"model\">\n<components>\n";
  for (std::size_t i = 0; i < parts.size(); ++i)
    out += "<component objectid=\"" + std::to_string(i + 1) + "\"/>\n";
  out += "</components>\n</object>\n";
  append_tail(out, object);
  return out;
}

std::string make_package(const std::string& model, const char* config_name, const std::string& config) {
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
  ZipWriter zip;
  zip.add("[Content_Types].xml", types);
  zip.add("_rels/.rels", relations);
  zip.add(kModelFile, model);
  if (config_name != nullptr) zip.add(config_name, config);
  return zip.finish();
}

[[noreturn]] void fail_to_read(const std::filesystem::path& path, const std::string& why) {
  throw FailureError(path.string() + ": is not the 3MF package that was written: " + why);
}

std::string read_entry(const std::filesystem::path& path, const char* name) {
  const auto close = [](zip_t* archive) { zip_discard(archive); };
  int code = 0;
  const std::unique_ptr<zip_t, decltype(close)> archive(
      zip_open(path.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &code), close);
  if (!archive) fail_to_read(path, "not a zip archive");
  zip_stat_t facts;
  zip_stat_init(&facts);
  if (zip_stat(archive.get(), name, 0, &facts) != 0) fail_to_read(path, std::string(name) + " is missing");
  std::string content(facts.size, '\0');
  zip_file_t* file = zip_fopen_index(archive.get(), facts.index, 0);
  if (file == nullptr) fail_to_read(path, std::string(name) + " cannot be opened");
  const zip_int64_t count = zip_fread(file, content.data(), content.size());
  zip_fclose(file);
  if (count < 0 || static_cast<std::size_t>(count) != content.size())
    fail_to_read(path, std::string(name) + " is cut off");
  return content;
}

pugi::xml_document parse(const std::filesystem::path& path, const char* name) {
  const std::string content = read_entry(path, name);
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(content.data(), content.size());
  if (!result) fail_to_read(path, std::string(name) + ": " + result.description());
  return document;
}

std::string metadata_of(pugi::xml_node node, const char* key) {
  return node.find_child_by_attribute("metadata", "key", key).attribute("value").as_string();
}

std::optional<double> parse_percent(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || std::string_view(end) != "%") return std::nullopt;
  return value;
}

std::optional<double> infill_of(const std::filesystem::path& path, pugi::xml_node node, bool is_modifier,
                                const char* key) {
  const std::optional<double> infill = parse_percent(metadata_of(node, key));
  if (infill.has_value() != is_modifier) fail_to_read(path, "a modifier has no infill, or a model one");
  return infill;
}

std::vector<ThreeMfPart> read_prusa_parts(const std::filesystem::path& path) {
  const pugi::xml_document document = parse(path, kPrusaConfig);
  std::vector<ThreeMfPart> parts;
  for (const pugi::xml_node volume : document.child("config").child("object").children("volume")) {
    const std::size_t first = volume.attribute("firstid").as_ullong();
    const std::size_t last = volume.attribute("lastid").as_ullong();
    const bool is_modifier = metadata_of(volume, "volume_type") == "ParameterModifier";
    parts.push_back({metadata_of(volume, "name"), first, last + 1 - first,
                     infill_of(path, volume, is_modifier, "fill_density")});
  }
  return parts;
}

std::vector<ThreeMfPart> read_orca_parts(const std::filesystem::path& path) {
  const pugi::xml_document model = parse(path, kModelFile);
  const pugi::xml_document document = parse(path, kOrcaConfig);
  const pugi::xml_node resources = model.child("model").child("resources");
  std::vector<ThreeMfPart> parts;
  std::size_t next = 0;
  for (const pugi::xml_node part : document.child("config").child("object").children("part")) {
    const pugi::xml_node triangles =
        resources.find_child_by_attribute("object", "id", part.attribute("id").as_string())
            .child("mesh")
            .child("triangles");
    const auto range = triangles.children("triangle");
    const auto count = static_cast<std::size_t>(std::distance(range.begin(), range.end()));
    const bool is_modifier = std::string_view(part.attribute("subtype").as_string()) == "modifier_part";
    parts.push_back({metadata_of(part, "name"), next, count,
                     infill_of(path, part, is_modifier, "sparse_infill_density")});
    next += count;
  }
  return parts;
}

}  // namespace

const char* name_of(ThreeMfFlavor flavor) {
  return flavor == ThreeMfFlavor::prusa ? "prusa" : "orca";
}

std::string to_3mf(const Mesh& mesh) {
  return make_package(single_mesh_model(mesh), nullptr, {});
}

std::string to_3mf(const Mesh& mesh, const std::vector<ThreeMfPart>& parts, ThreeMfFlavor flavor) {
  const bool is_prusa = flavor == ThreeMfFlavor::prusa;
  return make_package(is_prusa ? single_mesh_model(mesh) : component_model(mesh, parts),
                      config_file_of(flavor), is_prusa ? prusa_config(parts) : orca_config(parts));
}

Mesh with_void_shells_turned(Mesh mesh, const Solid& solid) {
  for (std::size_t i = solid.outer_triangle_count(); i < mesh.triangles.size(); ++i)
    std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
  return mesh;
}

std::vector<ThreeMfPart> modifier_parts(const Solid& solid, double infill_percent) {
  const std::size_t outer = solid.outer_triangle_count();
  return {{"model", 0, outer, std::nullopt},
          {"voids", outer, solid.mesh.triangles.size() - outer, infill_percent}};
}

std::vector<ThreeMfPart> read_3mf_parts(const std::filesystem::path& path, ThreeMfFlavor flavor) {
  return flavor == ThreeMfFlavor::prusa ? read_prusa_parts(path) : read_orca_parts(path);
}

}  // namespace aerate
