#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fmt/format.h>
#include <iterator>
#include <pugixml.hpp>
#include <utility>

#include "core/error.h"
#include "files/formats.h"
#include "files/output_file.h"
#include "files/three_mf.h"
#include "printing/slicers/slicers.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDefinition = "/usr/share/cura/resources/definitions/fdmprinter.def.json";
constexpr const char* kSearchPath = "CURA_ENGINE_SEARCH_PATH";

bool is_definition(const fs::path& file) {
  return file.string().ends_with(".def.json");
}

// The engine is given what is found in lines, and nothing of a file without any.
void require_some_settings(const fs::path& file) {
  const std::string text = read_text(file);
  bool has_some = is_definition(file) && !without_blanks(text).empty();
  for_each_line(text, [&](std::string_view line) {
    has_some = has_some || (setting_in_line(line) && !line.starts_with('#') && !line.starts_with('['));
    return !has_some;
  });
  if (!has_some)
    throw InputError(file.string() + ": holds no settings, and the engine would print with its defaults",
                     "give a .def.json, or lines setting=value");
}

// CuraEngine looks for what a definition inherits in folders that a variable names.
std::string search_path(const fs::path& definition) {
  const char* given = std::getenv(kSearchPath);
  const fs::path folder = fs::absolute(definition).parent_path();
  return (given != nullptr ? std::string(given) + ":" : std::string()) + folder.string() + ":" +
         (folder.parent_path() / "extruders").string();
}

// What a modifier is to Cura. Cura's window derives the distance of lines from the density, the engine does not.
constexpr const char* kInfillMesh = "infill_mesh";
constexpr const char* kInfill = "infill_sparse_density";
constexpr const char* kPattern = "infill_pattern";
constexpr std::array<std::pair<const char*, const char*>, 5> kModifierSettings{{{kInfillMesh, "True"},
                                                                                {"infill_mesh_order", "1"},
                                                                                {"wall_line_count", "0"},
                                                                                {"top_layers", "0"},
                                                                                {"bottom_layers", "0"}}};

// "12.5%"
double share_of(const ObjectPart& voids) {
  return number_at_front(voids.infill).value_or(0) / 100;
}

std::string metadata(std::string_view name, std::string_view value) {
  return fmt::format("<metadata name=\"cura:{}\" preserve=\"true\" type=\"xs:string\">{}</metadata>\n", name,
                     value);
}

std::string notes_of(const ObjectPart& voids) {
  std::string notes = "<metadatagroup>\n";
  for (const auto& [name, value] : kModifierSettings) notes += metadata(name, value);
  notes += metadata(kInfill, fmt::format("{:g}", 100 * share_of(voids)));
  if (!voids.pattern.empty()) notes += metadata(kPattern, voids.pattern);
  return notes + "</metadatagroup>\n";
}

std::string file_for(const Mesh& mesh, const ObjectPart& model, const ObjectPart& voids,
                     const std::string& object_name) {
  ThreeMfExtras extras;
  extras.component_triangles = {model.triangle_count, voids.triangle_count};
  extras.component_notes = {"", notes_of(voids)};
  extras.namespaces = "xmlns:cura=\"http://software.ultimaker.com/xml/cura/3mf/2015/10\"";
  extras.object_name = object_name;
  return to_3mf(mesh, extras);
}

// The model and its voids, of a package that was written here.
std::vector<Mesh> read_meshes(const fs::path& file) {
  std::vector<Mesh> meshes = read_3mf_meshes(file);
  if (meshes.size() != 2) throw not_as_written(file, "there are not two meshes");
  return meshes;
}

Mesh read_mesh(const fs::path& file) {
  std::vector<Mesh> meshes = read_meshes(file);
  Mesh mesh = std::move(meshes[0]);
  const auto offset = static_cast<std::uint32_t>(mesh.positions.size());
  std::ranges::copy(meshes[1].positions, std::back_inserter(mesh.positions));
  for (const Triangle& t : meshes[1].triangles)
    mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return mesh;
}

std::string setting_of(const pugi::xml_node& object, std::string_view name) {
  const std::string key = "cura:" + std::string(name);
  return object.child("metadatagroup")
      .find_child_by_attribute("metadata", "name", key.c_str())
      .text()
      .as_string();
}

std::vector<ObjectPart> read_parts(const fs::path& file) {
  const pugi::xml_document document = read_document(file, kThreeMfModel);
  std::vector<ObjectPart> parts;
  std::size_t next = 0;
  for (const pugi::xml_node object : document.child("model").child("resources").children("object")) {
    const auto triangles = object.child("mesh").child("triangles").children("triangle");
    const auto count = static_cast<std::size_t>(std::distance(triangles.begin(), triangles.end()));
    if (count == 0) continue;
    const bool is_modifier = setting_of(object, kInfillMesh) == "True";
    const std::string infill = is_modifier ? setting_of(object, kInfill) + "%" : "";
    parts.push_back(
        {is_modifier ? "voids" : "model", next, count, is_modifier, infill, setting_of(object, kPattern)});
    next += count;
  }
  return parts;
}

// The engine reads STL only, and takes what is printed otherwise from what follows a file's name.
void add_parts(ChildCommand& command, const SliceJob& job, double line_width) {
  const std::vector<Mesh> meshes = read_meshes(job.model);
  const std::vector<ObjectPart> parts = read_parts(job.model);
  const std::string stem = job.model.stem().string();
  const fs::path model = job.scratch / (stem + ".stl"), voids = job.scratch / (stem + "-voids.stl");
  write_mesh(meshes[0], model, MeshFormat::stl);
  write_mesh(meshes[1], voids, MeshFormat::stl);
  command.add({"-l", model, "-l", voids});
  const auto set = [&](std::string_view name, std::string_view value) {
    command.add({"-s", fmt::format("{}={}", name, value)});
  };
  for (const auto& [name, value] : kModifierSettings)
    set(name, value == std::string_view("True") ? "true" : value);
  const double share = share_of(parts.back());
  set("infill_line_distance", fmt::format("{:g}", share > 0 ? line_width / share : 0));
  if (!parts.back().pattern.empty()) set(kPattern, parts.back().pattern);
}

ChildCommand command_for(const fs::path& program, const SliceJob& job) {
  fs::path definition = kDefinition;
  double line_width = 0.4;  // of the definition, unless a setting says otherwise
  std::vector<std::string> settings;
  for (const fs::path& file : job.settings.files) {
    if (is_definition(file)) {
      definition = file;
      continue;
    }
    for_each_line(read_text(file), [&](std::string_view line) {
      const auto setting = setting_in_line(line);
      if (!setting || line.starts_with('#') || line.starts_with('[')) return true;
      settings.insert(settings.end(), {"-s", std::string(setting->key) + "=" + std::string(setting->value)});
      if (setting->key == "infill_line_width")
        line_width = number_at_front(setting->value).value_or(line_width);
      return true;
    });
  }
  ChildCommand command{
      {program, "slice", "-v", "-j", definition}, {{kSearchPath, search_path(definition)}}, job.scratch};
  // Settings after -j are the machine's; the model's own follow -l.
  for (const std::string& setting : settings) command.add({setting});
  if (!job.pattern.empty()) command.add({"-s", std::string(kPattern) + "=" + job.pattern});
  command.add({"-o", job.gcode});
  if (job.model.extension() == ".3mf") {
    add_parts(command, job, line_width);
  } else {
    command.add({"-l", job.model});
  }
  return command;
}

// CuraEngine writes a header before it knows the figures, and prints the true one; Cura puts that in.
void replace_header(const fs::path& gcode, std::string_view printed) {
  constexpr std::string_view kBegin = "Gcode header after slicing:\n", kEnd = "End of gcode header.";
  const std::size_t begin = printed.find(kBegin), end = printed.find(kEnd);
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return;
  std::string header;
  for_each_line(printed.substr(begin + kBegin.size(), end - begin - kBegin.size()),
                [&](std::string_view line) {
                  if (line.starts_with(';')) header.append(line).append("\n");
                  return true;
                });
  std::string text = read_text(gcode);
  const std::size_t old_end = text.find("\n\n");
  if (!text.starts_with(";FLAVOR") || old_end == std::string::npos) return;
  text.replace(0, old_end + 1, header);
  write_bytes(text, gcode);
}

GcodeFigures collect(const SliceJob& job, const std::string& printed) {
  constexpr std::string_view kVolume = "Filament (mm^3): ";
  constexpr double kCubicMillimetresPerCm3 = 1000;
  GcodeFigures figures;
  std::error_code error;
  if (fs::exists(job.gcode, error)) replace_header(job.gcode, printed);
  if (const std::size_t at = printed.find(kVolume); at != std::string::npos)
    figures.filament_cm3 =
        std::strtod(printed.c_str() + at + kVolume.size(), nullptr) / kCubicMillimetresPerCm3;
  return figures;
}

// "0.228916m, 1.5m" of several extruders.
std::optional<double> length_of(std::string_view text) {
  constexpr double kMillimetresPerMetre = 1000;
  double metres = 0;
  while (const std::optional<double> length = take_number(text)) {
    metres += *length;
    if (text.starts_with('m')) text.remove_prefix(1);
    if (text.starts_with(',')) text.remove_prefix(1);
  }
  return metres * kMillimetresPerMetre;
}

// Before the settings that Cura itself puts behind it.
bool is_complete(std::string_view gcode) {
  return gcode.find("\n;End of Gcode") != std::string_view::npos;
}

bool begins_layer(std::string_view comment) {
  return comment.starts_with(";LAYER:");
}

}  // namespace

SlicerProfile cura_engine() {
  SlicerProfile row;
  row.name = "cura-engine";
  row.family = {"Cura"};
  row.programs = {"CuraEngine", "cura-engine", "curaengine"};
  row.settings = {".def.json and lines name=value (CuraEngine)"};
  row.command = command_for;
  row.check_settings = require_some_settings;
  row.collect = collect;
  row.marks = {"Generated with Cura"};
  row.figures = {{"Filament used", &GcodeFigures::filament_mm, length_of},
                 {"TIME", &GcodeFigures::seconds, number_at_front}};
  row.begins_layer = begins_layer;
  row.is_complete = is_complete;
  row.modifiers = {
      .flavor = "cura", .file = file_for, .read = read_parts, .read_mesh = read_mesh, .has_lightning = true};
  row.patterns = {{kLightning, "holds up tops, no strength"}, {"cubicsubdiv", "denser near the surface"}};
  return row;
}

}  // namespace aerate
