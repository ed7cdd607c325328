#include <fmt/format.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "core/error.h"
#include "files/output_file.h"
#include "files/three_mf.h"
#include "printing/slicers/figure_values.h"
#include "printing/slicers/slicers.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPartList = "Metadata/model_settings.config";

bool is_filament(const fs::path& settings) {
  std::string text = read_text(settings);
  std::erase_if(text, [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; });
  return text.find("\"type\":\"filament\"") != std::string::npos;
}

void require_json_settings(const fs::path& file) {
  const auto json = nlohmann::json::parse(read_text(file), nullptr, false);
  if (!json.is_object() || json.empty())
    throw InputError(file.string() + (json.is_object() ? ": holds no settings" : ": is no JSON object"),
                     "give settings that the slicer exported");
}

// A copy without the programs that would be run on the G-code, whatever way their names are written in.
fs::path without_post_processing(const fs::path& settings, const fs::path& copy) {
  auto json = nlohmann::ordered_json::parse(read_text(settings), nullptr, false);
  if (!json.is_object())
    throw InputError(settings.string() + ": is no JSON object", "give settings that the slicer exported");
  json.erase(kPostProcess);
  write_bytes(json.dump(), copy);
  return copy;
}

ChildCommand command_for(const fs::path& program, const SliceJob& job) {
  ChildCommand command{{program, "--slice", "0", "--outputdir", job.scratch}, {}, job.scratch};
  std::string filaments, others;
  std::size_t number = 0;
  for (const fs::path& file : job.settings.files) {
    std::string& list = is_filament(file) ? filaments : others;
    if (!list.empty()) list += ';';
    list += without_post_processing(file, job.scratch / fmt::format("settings-{}.json", number++)).string();
  }
  if (!others.empty()) command.add({"--load-settings", others});
  if (!filaments.empty()) command.add({"--load-filaments", filaments});
  command.add({job.model});
  return command;
}

// The name of the G-code cannot be chosen.
GcodeFigures collect(const SliceJob& job, const std::string& /*printed*/) {
  std::error_code error;
  fs::rename(job.scratch / "plate_1.gcode", job.gcode, error);
  return {};
}

// "4m 54s; total estimated time: 10m 22s", of which the second is what the printer is busy for.
std::optional<double> total_seconds(std::string_view text) {
  constexpr std::string_view kTotal = "total estimated time:";
  const std::size_t at = text.find(kTotal);
  return seconds_of(at == std::string_view::npos ? text : text.substr(at + kTotal.size()));
}

// Bambu Studio says cm3 and means mm3.
std::optional<double> cm3_of_mm3(std::string_view text) {
  const auto mm3 = sum_of(text);
  return mm3 ? std::optional(*mm3 / 1000) : std::nullopt;
}

// Subtypes of parts.
constexpr const char* kModifier = "modifier_part";
constexpr const char* kBlocker = "support_blocker";
constexpr const char* kBody = "normal_part";
constexpr const char* kInfillPattern = "sparse_infill_pattern";
// Of an object that has supports of its own.
constexpr const char* kNoOthers =
    "  <metadata key=\"enable_support\" value=\"0\" />\n  <metadata key=\"thick_bridges\" value=\"0\" />\n";

// A mesh for each part, put together as components.
constexpr const char* kTemplate = R"(<?xml version="1.0"?>
<config>
 <object id="3">
  <metadata key="name" value="{3}" />
  <part id="1" subtype="normal_part">
   <metadata key="name" value="{0}" />
   <metadata key="matrix" value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1" />
  </part>
  <part id="2" subtype="{4}">
   <metadata key="name" value="{1}" />
   <metadata key="matrix" value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1" />
{2}  </part>
{5} </object>
</config>
)";

// Of a part; nothing for an empty value.
std::string setting(const char* key, const std::string& value) {
  if (value.empty()) return {};
  return fmt::format("   <metadata key=\"{}\" value=\"{}\" />\n", key, value);
}

std::string file_for(const Mesh& mesh, const ObjectPart& model, const ObjectPart& voids,
                     const std::string& object_name) {
  ThreeMfExtras extras;
  extras.object_name = object_name;
  const std::string object = xml_value(object_name.empty() ? model.name : object_name);
  extras.component_triangles = {model.triangle_count, voids.triangle_count};
  // One of Bambu Studio's versions would make Orca ask whether it is to be converted, and its command line crash.
  extras.application = "aerate " AERATE_VERSION;
  std::string settings =
      setting("sparse_infill_density", voids.infill) + setting(kInfillPattern, voids.pattern);
  const bool are_supports = !voids.settings.empty();
  for (const PartSetting& each : voids.settings) settings += setting(each.key.c_str(), each.value);
  const char* const kind = are_supports ? kBody : voids.blocks_support ? kBlocker : kModifier;
  extras.entries = {{kPartList, fmt::format(kTemplate, model.name, voids.name, settings, object, kind,
                                            are_supports ? kNoOthers : "")}};
  return to_3mf(mesh, extras);
}

std::string named(const Mesh& mesh, const ObjectPart& /*model*/, const std::string& object_name) {
  ThreeMfExtras extras;
  extras.object_name = object_name;
  return to_3mf(mesh, extras);
}

bool is_modifier(const pugi::xml_node& part) {
  return std::string_view(part.attribute("subtype").as_string()) == kModifier;
}

bool is_blocker(const pugi::xml_node& part) {
  return std::string_view(part.attribute("subtype").as_string()) == kBlocker;
}

bool is_body(const pugi::xml_node& part) {
  return std::string_view(part.attribute("subtype").as_string(kBody)) == kBody;
}

bool is_own_part(const pugi::xml_node& part) {
  if (is_blocker(part)) return metadata_of(part, "name") == kSupportBlockers;
  return is_body(part) && are_named_supports(part, kInfillPattern);
}

// Of a body; all but its name and place.
std::vector<PartSetting> settings_of(const pugi::xml_node& part) {
  std::vector<PartSetting> settings;
  for (const pugi::xml_node metadata : part.children("metadata")) {
    PartSetting setting{metadata.attribute("key").as_string(), metadata.attribute("value").as_string()};
    if (setting.key != "name" && setting.key != "matrix") settings.push_back(std::move(setting));
  }
  return settings;
}

std::vector<ObjectPart> read_parts(const fs::path& package) {
  const pugi::xml_document list = read_document(package, kPartList);
  const pugi::xml_document model = read_document(package, kThreeMfModel);
  const pugi::xml_node meshes = model.child("model").child("resources");
  std::vector<ObjectPart> parts;
  std::size_t next = 0;
  for (const pugi::xml_node part : list.child("config").child("object").children("part")) {
    const pugi::xml_node object =
        meshes.find_child_by_attribute("object", "id", part.attribute("id").as_string());
    const auto triangles = object.child("mesh").child("triangles").children("triangle");
    const auto count = static_cast<std::size_t>(std::distance(triangles.begin(), triangles.end()));
    const bool is_solid = !is_modifier(part) && !is_blocker(part);
    ObjectPart read{metadata_of(part, "name"),
                    next,
                    count,
                    is_modifier(part),
                    is_solid ? "" : metadata_of(part, "sparse_infill_density"),
                    is_solid ? "" : metadata_of(part, kInfillPattern),
                    is_blocker(part)};
    if (is_solid) read.settings = settings_of(part);
    parts.push_back(std::move(read));
    next += count;
  }
  return parts;
}

std::optional<std::string> other_kind(const pugi::xml_node& part) {
  if (!is_body(part)) return part.attribute("subtype").as_string();
  return is_own_part(part) ? std::optional<std::string>(kSupports) : std::nullopt;
}

VolumeTriangles triangles_of(const pugi::xml_node& part) {
  return {part.attribute("id").as_uint(), 0, 0};
}

// Its settings name presets of machine, process and filament together, which the command line takes one by one.
ProjectFacts project_facts(const fs::path& package) {
  ProjectFacts facts;
  facts.has_unread_settings = !entry_or_nothing(package, "Metadata/project_settings.config").empty();
  return facts;
}

bool supports_everywhere(std::string_view gcode) {
  return setting_in(gcode, "enable_support") == "1" &&
         setting_in(gcode, "support_on_build_plate_only").value_or("0") == "0" &&
         setting_in(gcode, "support_type").value_or("(auto)").find("(auto)") != std::string::npos;
}

// The block of settings ends the file; older versions have none.
bool is_complete(std::string_view gcode) {
  return gcode.ends_with('\n') && (gcode.find("; CONFIG_BLOCK_START") == std::string_view::npos ||
                                   gcode.find("; CONFIG_BLOCK_END") != std::string_view::npos);
}

}  // namespace

SlicerProfile orca_slicer() {
  SlicerProfile row = slic3r();  // where it comes from
  row.name = "orca-slicer";
  row.family = {"OrcaSlicer", "Bambu Studio"};
  row.untested = true;
  row.programs = {"orca-slicer", "OrcaSlicer"};
  row.settings = {"JSON of machine, process and filament (OrcaSlicer)"};
  row.command = command_for;
  row.collect = collect;
  row.check_settings = require_json_settings;
  row.list_settings = nullptr;
  row.is_complete = is_complete;
  row.marks = {"generated by OrcaSlicer", "BambuStudio"};
  // In the head of Bambu Studio's G-code.
  row.figures.push_back({"model printing time", &GcodeFigures::seconds, total_seconds});
  row.figures.push_back({"total filament length [mm]", &GcodeFigures::filament_mm, sum_of});
  row.figures.push_back({"total filament volume [cm^3]", &GcodeFigures::filament_cm3, cm3_of_mm3});
  row.figures.push_back({"total filament weight [g]", &GcodeFigures::filament_g, sum_of});
  row.calls_hook = {"orca-slicer"};
  row.project = project_facts;
  row.modifiers = {
      .flavor = "orca",
      .volumes = VolumeList{kPartList, "part", other_kind, is_modifier, triangles_of, is_own_part},
      .file = file_for,
      .named = named,
      .read = read_parts,
      .elsewhere =
          "open it as a project: an import into an open one may lose the infill; PrusaSlicer would "
          "print two bodies in one place: --flavor prusa is for that",
      .has_lightning = true,
      .has_blockers = true,
      .support_settings = {{"wall_loops", "1"},
                           {"sparse_infill_density", "10%"},
                           {kInfillPattern, kLightning},
                           {"top_shell_layers", "1"},
                           {"bottom_shell_layers", "0"},
                           {"minimum_sparse_infill_area", "0"}}};
  row.supports_everywhere = supports_everywhere;
  row.supports_on_plate = "support_on_build_plate_only = 1";
  return row;
}

}  // namespace aerate
