#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <pugixml.hpp>

#include "files/three_mf.h"
#include "printing/slicers/ini_settings.h"
#include "printing/slicers/print_settings_file.h"
#include "printing/slicers/slicers.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

constexpr const char* kBlockerType = "SupportBlocker";
constexpr const char* kInfillPattern = "fill_pattern";
// Alphas of 3.0 read modifiers in packages of versions below 2.99 only (issue 15694), 2.9 warns of packages of newer ones than it is.
constexpr const char* kApplication = "PrusaSlicer-2.9.0";
constexpr const char* kPartList = "Metadata/Slic3r_PE_model.config";

// Ends with its settings; newer versions say so in a line of its own.
bool is_complete(std::string_view gcode) {
  // 3.0 has a block of JSON before.
  const std::size_t begin = gcode.rfind("_config = begin\n");
  if (begin != std::string_view::npos) return gcode.find("_config = end", begin) != std::string_view::npos;
  return ends_with_setting(gcode);
}

ChildCommand command_for(const std::filesystem::path& program, const SliceJob& job) {
  ChildCommand command{{program, "--export-gcode"}, {}, job.scratch};
  for (const std::filesystem::path& file : job.settings.files) command.add({"--load", file});
  if (!job.pattern.empty()) command.add({"--fill-pattern", job.pattern});
  if (job.keep_place || job.place) command.add({"--dont-arrange"});
  if (job.place) command.add({"--center", fmt::format("{},{}", job.place->x, job.place->y)});
  if (job.says_text) command.add({"--binary-gcode=0"});
  command.add({"--post-process", "", "--output", job.gcode, job.model});
  return command;
}

// One mesh; parts are ranges of its triangles. Versions before 2.3 look for "modifier" instead of a type.
std::string volume_of(const ObjectPart& part, const std::string& name) {
  constexpr const char* kBody = R"(  <volume firstid="{1}" lastid="{2}">
   <metadata type="volume" key="name" value="{0}" />
   <metadata type="volume" key="volume_type" value="ModelPart" />
{3}  </volume>
)";
  constexpr const char* kSetting = R"(   <metadata type="volume" key="{}" value="{}" />
)";
  constexpr const char* kModifier = R"(  <volume firstid="{1}" lastid="{2}">
   <metadata type="volume" key="name" value="{0}" />
   <metadata type="volume" key="volume_type" value="ParameterModifier" />
   <metadata type="volume" key="modifier" value="1" />
   <metadata type="volume" key="fill_density" value="{3}" />
{4}  </volume>
)";
  constexpr const char* kBlocker = R"(  <volume firstid="{1}" lastid="{2}">
   <metadata type="volume" key="name" value="{0}" />
   <metadata type="volume" key="volume_type" value="SupportBlocker" />
  </volume>
)";
  // What is small in a modifier would become solid by the print's own setting.
  constexpr const char* kPattern = R"(   <metadata type="volume" key="fill_pattern" value="{}" />
   <metadata type="volume" key="solid_infill_below_area" value="0" />
)";
  const std::size_t last = part.end() - 1;
  if (part.blocks_support) return fmt::format(kBlocker, name, part.first_triangle, last);
  if (!part.is_modifier) {
    std::string settings;
    for (const PartSetting& each : part.settings) settings += fmt::format(kSetting, each.key, each.value);
    return fmt::format(kBody, name, part.first_triangle, last, settings);
  }
  const std::string pattern = part.pattern.empty() ? "" : fmt::format(kPattern, part.pattern);
  return fmt::format(kModifier, name, part.first_triangle, last, part.infill, pattern);
}

// An object of this name, as XML has it.
ThreeMfExtras with_part_list(const std::string& object_name, const std::string& shown,
                             const std::string& volumes, bool has_supports = false) {
  constexpr const char* kList = R"(<?xml version="1.0"?>
<config>
 <object id="1" instances_count="1">
  <metadata type="object" key="name" value="{}" />
{}{} </object>
</config>
)";
  // Thick bridges would hang down into the gap.
  constexpr const char* kNoOthers = R"(  <metadata type="object" key="support_material" value="0" />
  <metadata type="object" key="thick_bridges" value="0" />
)";
  ThreeMfExtras extras;
  extras.object_name = object_name;
  extras.application = kApplication;
  extras.entries = {{kPartList, fmt::format(kList, shown, has_supports ? kNoOthers : "", volumes)}};
  return extras;
}

std::string file_for(const Mesh& mesh, const ObjectPart& model, const ObjectPart& voids,
                     const std::string& object_name) {
  return to_3mf(mesh, with_part_list(object_name, xml_value(object_name.empty() ? model.name : object_name),
                                     volume_of(model, model.name) + volume_of(voids, voids.name),
                                     !voids.settings.empty()));
}

std::string named(const Mesh& mesh, const ObjectPart& model, const std::string& object_name) {
  const std::string shown = xml_value(object_name);
  return to_3mf(mesh, with_part_list(object_name, shown, volume_of(model, shown)));
}

// Of a body; all but its name and kind.
std::vector<PartSetting> settings_of(const pugi::xml_node& volume) {
  std::vector<PartSetting> settings;
  for (const pugi::xml_node metadata : volume.children("metadata")) {
    PartSetting setting{metadata.attribute("key").as_string(), metadata.attribute("value").as_string()};
    if (setting.key != "name" && setting.key != "volume_type") settings.push_back(std::move(setting));
  }
  return settings;
}

std::vector<ObjectPart> read_parts(const std::filesystem::path& package) {
  const pugi::xml_document list = read_document(package, kPartList);
  std::vector<ObjectPart> parts;
  for (const pugi::xml_node volume : list.child("config").child("object").children("volume")) {
    const std::size_t first = volume.attribute("firstid").as_ullong();
    const std::size_t last = volume.attribute("lastid").as_ullong();
    const std::string type = metadata_of(volume, "volume_type");
    const bool is_body = type == "ModelPart";
    ObjectPart part{metadata_of(volume, "name"),
                    first,
                    last + 1 - first,
                    type == "ParameterModifier",
                    is_body ? "" : metadata_of(volume, "fill_density"),
                    is_body ? "" : metadata_of(volume, "fill_pattern"),
                    type == kBlockerType};
    if (is_body) part.settings = settings_of(volume);
    parts.push_back(std::move(part));
  }
  return parts;
}

bool is_own_part(const pugi::xml_node& volume) {
  const std::string type = metadata_of(volume, "volume_type");
  const std::string name = metadata_of(volume, "name");
  if (type == kBlockerType) return name == kSupportBlockers;
  return (type.empty() || type == "ModelPart") && are_named_supports(volume, kInfillPattern);
}

std::optional<std::string> other_kind(const pugi::xml_node& volume) {
  const std::string type = metadata_of(volume, "volume_type");
  if (is_own_part(volume) && type != kBlockerType) return kSupports;
  if (type.empty() && metadata_of(volume, "modifier") == "1") return "modifier";
  return type.empty() || type == "ModelPart" ? std::nullopt : std::optional(type);
}

bool is_modifier(const pugi::xml_node& volume) {
  return metadata_of(volume, "volume_type") == "ParameterModifier" ||
         (metadata_of(volume, "volume_type").empty() && metadata_of(volume, "modifier") == "1");
}

VolumeTriangles triangles_of(const pugi::xml_node& volume) {
  return {std::nullopt, static_cast<std::size_t>(volume.attribute("firstid").as_ullong()),
          static_cast<std::size_t>(volume.attribute("lastid").as_ullong())};
}

// Settings of an object or a volume; what else stands there is said of every project.
std::optional<std::string> setting_in_metadata(const pugi::xml_node& metadata) {
  const std::string key = metadata.attribute("key").as_string(),
                    value = metadata.attribute("value").as_string();
  for (const char* other : {"name", "matrix", "volume_type", "modifier"}) {
    if (key == other) return std::nullopt;
  }
  if (key.starts_with("source_")) return std::nullopt;  // where the part was read from
  if (key == "extruder" && (value == "0" || value == "1")) return std::nullopt;  // the one that prints anyway
  return key + " = " + value;
}

void read_object(const pugi::xml_node& object, ProjectFacts& facts) {
  if (facts.object_name.empty()) facts.object_name = metadata_of(object, "name");
  const auto read_metadata = [&](const pugi::xml_node& node) {
    for (const pugi::xml_node metadata : node.children("metadata")) {
      if (const auto setting = setting_in_metadata(metadata))
        facts.beyond_mesh.push_back("settings of the object (" + *setting + ")");
    }
  };
  read_metadata(object);
  for (const pugi::xml_node volume : object.children("volume")) read_metadata(volume);
}

ProjectFacts project_facts(const std::filesystem::path& package) {
  // Entries of a package with an element that says something, and attributes of painted triangles.
  constexpr std::array<std::array<const char*, 3>, 3> kLists{
      {{"Metadata/Prusa_Slicer_custom_gcode_per_print_z.xml", "<code ",
        "colour changes, pauses or G-code between layers"},
       {"Metadata/Prusa_Slicer_layer_config_ranges.xml", "<range ", "settings of layers"},
       {"Metadata/Slic3r_PE_layer_heights_profile.txt", "object_id=", "variable layer heights"}}};
  constexpr std::array<std::array<const char*, 2>, 4> kPaint{{{":custom_seam=\"", "painted seams"},
                                                              {":custom_supports=\"", "painted supports"},
                                                              {":mmu_segmentation=\"", "painted colours"},
                                                              {":fuzzy_skin=\"", "painted fuzzy skin"}}};
  ProjectFacts facts;
  const std::string config = entry_or_nothing(package, kPartList);
  pugi::xml_document document;
  if (document.load_buffer(config.data(), config.size())) {
    for (const pugi::xml_node object : document.child("config").children("object"))
      read_object(object, facts);
  }
  for (const auto& [entry, element, words] : kLists) {
    if (entry_or_nothing(package, entry).find(element) != std::string::npos)
      facts.beyond_mesh.emplace_back(words);
  }
  facts.settings = plain_settings(entry_or_nothing(package, "Metadata/Slic3r_PE.config"));
  const std::string model = entry_or_nothing(package, kThreeMfModel);
  for (const auto& [attribute, words] : kPaint) {
    if (model.find(attribute) != std::string::npos) facts.beyond_mesh.emplace_back(words);
  }
  return facts;
}

// "; printing object NAME id:0 copy 0"
std::optional<std::string> labelled_object(std::string_view gcode) {
  constexpr std::string_view kBegin = "\n; printing object ", kEnd = " id:";
  const std::size_t begin = gcode.find(kBegin);
  if (begin == std::string_view::npos) return std::nullopt;
  std::string_view line = gcode.substr(begin + kBegin.size());
  line = line.substr(0, line.find('\n'));
  const std::size_t end = line.rfind(kEnd);
  return end == std::string_view::npos ? std::nullopt : std::optional(std::string(line.substr(0, end)));
}

std::vector<SparsePattern> sparse_patterns() {
  return {{kLightning, "holds up tops, no strength"},
          {"supportcubic", "denser under tops"},
          {"adaptivecubic", "denser near the surface"}};
}

// "0.45mm" of a comment that says how wide lines are, "20%", "5"
std::optional<double> number_of(std::string_view gcode, std::string_view key) {
  const std::optional<std::string> text = setting_in(gcode, key);
  return text ? number_at_front(*text) : std::nullopt;
}

// What is not said is as in the slicer's profiles.
std::optional<DescribedPrint> described_print(std::string_view gcode) {
  const std::optional<double> infill = number_of(gcode, "fill_density");
  if (!infill || *infill < 0 || *infill > 100) return std::nullopt;
  DescribedPrint print;
  PrintSettings& settings = print.settings;
  settings.infill = *infill / 100;
  print.pattern = setting_in(gcode, "fill_pattern").value_or("");
  settings.pattern =
      print.pattern.empty() || print.pattern == "gyroid" ? InfillPattern::gyroid : InfillPattern::lines;
  const std::vector<SparsePattern> sparse = sparse_patterns();
  print.is_predictable = std::ranges::find(sparse, print.pattern, &SparsePattern::name) == sparse.end();
  const auto count = [&](std::string_view key, int& value) {
    if (const auto number = number_of(gcode, key)) value = static_cast<int>(*number);
  };
  count("perimeters", settings.perimeters);
  count("top_solid_layers", settings.top_layers);
  count("bottom_solid_layers", settings.bottom_layers);
  const auto length = [&](std::string_view key, double& value) {
    if (const auto number = number_of(gcode, key); number && *number > 0) value = *number;
  };
  length("layer_height", settings.layer_height);
  length("perimeters extrusion width", settings.line_width);
  if (const auto version = version_of("PrusaSlicer", gcode)) settings.rules = rules_of(*version);
  if (settings.rules == SolidRules::prusa_2_5) return print;
  settings.vertical_shells =
      parse_vertical_shells(setting_in(gcode, "ensure_vertical_shell_thickness").value_or(""))
          .value_or(settings.vertical_shells);
  settings.walls =
      parse_walls(setting_in(gcode, "perimeter_generator").value_or("")).value_or(settings.walls);
  return print;
}

}  // namespace

SlicerProfile prusa_slicer() {
  SlicerProfile row = slic3r();  // where it comes from
  row.name = "prusa-slicer";
  row.family = {"PrusaSlicer", "SuperSlicer"};
  row.runs_also = "SuperSlicer";
  row.programs = {"prusa-slicer", "PrusaSlicer", "prusa-slicer-console", "superslicer", "SuperSlicer"};
  row.settings = {".ini or G-code (PrusaSlicer, Slic3r)"};
  row.command = command_for;
  row.is_complete = is_complete;
  row.needs_place_from = SlicerVersion{2, 8, 0};  // arranges meshes, but no 3MF
  row.marks = {"generated by PrusaSlicer", "generated by SuperSlicer"};
  row.calls_hook = {"prusa-slicer", "super-slicer"};
  row.repeats_gcode = true;
  row.project = project_facts;
  row.labelled_object = labelled_object;
  row.modifiers = {
      .flavor = "prusa",
      .volumes = VolumeList{kPartList, "volume", other_kind, is_modifier, triangles_of, is_own_part},
      .file = file_for,
      .named = named,
      .read = read_parts,
      .elsewhere = "OrcaSlicer and Bambu Studio would print it as one solid body: --flavor orca is for these",
      .has_lightning = true,
      .has_blockers = true,
      .support_settings = {{"perimeters", "1"},
                           {"fill_density", "10%"},
                           {kInfillPattern, kLightning},
                           {"top_solid_layers", "1"},
                           {"bottom_solid_layers", "0"},
                           // Else a narrow body would be solid.
                           {"solid_infill_below_area", "0"},
                           {"external_perimeter_speed", "100%"},
                           {"small_perimeter_speed", "100%"}}};
  row.patterns = sparse_patterns();
  row.described_print = described_print;
  row.no_supports = {{"support_material", "0"}};
  for (const char* style : {"grid", "snug", "organic"}) {
    row.own_supports.push_back({style,
                                {{"support_material", "1"},
                                 {"support_material_auto", "1"},
                                 {"support_material_threshold", "45"},
                                 {"support_material_style", style}},
                                {}});
  }
  row.own_supports.back().from = {2, 6, 0};
  return row;
}

}  // namespace aerate
