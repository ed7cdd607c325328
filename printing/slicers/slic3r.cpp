#include <algorithm>
#include <array>
#include <fmt/compile.h>
#include <fmt/format.h>
#include <iterator>
#include <map>
#include <pugixml.hpp>
#include <utility>

#include "core/error.h"
#include "files/decimal.h"
#include "files/output_file.h"
#include "files/text_scan.h"
#include "files/three_mf.h"
#include "printing/slicers/figure_values.h"
#include "printing/slicers/gcode_machine.h"
#include "printing/slicers/ini_settings.h"
#include "printing/slicers/slicers.h"
#include "printing/slicers/text_file.h"

namespace aerate {
namespace {

namespace fs = std::filesystem;

// The volume in "192.5mm (1.4cm3)".
std::optional<double> number_in_brackets(std::string_view text) {
  const std::size_t open = text.find('(');
  return open == std::string_view::npos ? std::nullopt : number_at_front(text.substr(open + 1));
}

bool begins_layer(std::string_view comment) {
  return comment == ";LAYER_CHANGE" || comment == "; CHANGE_LAYER";
}

// "192.5mm (1.4cm3)" and "3.9g" stand behind the same label.
std::optional<double> number_of_unit(std::string_view text, std::string_view unit) {
  const std::optional<double> number = take_number(text);
  return text.starts_with(unit) ? number : std::nullopt;
}
std::optional<double> millimetres_of(std::string_view text) {
  return number_of_unit(text, "mm");
}
std::optional<double> grams_of(std::string_view text) {
  return number_of_unit(text, "g");
}

// Of an extruder, mm: what has gone in, and the most of it, since it may end retracted.
struct Feed {
  double sum = 0, most = 0;
};

// Of all extruders, mm: by the moves, and what Slic3r says.
struct Filament {
  double moved = 0, said = 0;
};

Filament filament_in(std::string_view gcode) {
  constexpr std::string_view kSaid = "; filament used = ";
  Filament filament;
  std::map<int, Feed> extruders;
  Feed* feed = &extruders[0];
  GcodeMachine machine;
  for_each_line(gcode, [&](std::string_view line) {
    machine.run(line);
    if (machine.moved()) {
      feed->sum += machine.filament();
      feed->most = std::max(feed->most, feed->sum);
    } else if (line.starts_with('T')) {
      if (const auto tool = command_word(command_in(line))) feed = &extruders[tool->code];
    } else if (line.starts_with(kSaid)) {
      filament.said += millimetres_of(line.substr(kSaid.size())).value_or(0);
    }
    return true;
  });
  for (const auto& [tool, each] : extruders) filament.moved += each.most;
  return filament;
}

// While the disk is full lines get lost, and when it is no longer the rest is written. G-code of the user's own
// may move more than Slic3r says, and by G91 and G90 change what E means.
bool has_hole(std::string_view gcode) {
  constexpr double kMissing = 0.01;  // relative; measured: none but for the last decimal
  constexpr double kRounding = 0.1;  // mm
  if (gcode.find("\nG91") != std::string_view::npos) return false;
  const Filament filament = filament_in(gcode);
  return filament.moved < filament.said * (1 - kMissing) - kRounding;
}

// The last of its settings is there, and what was to be extruded before.
bool is_complete(std::string_view gcode) {
  return gcode.find("\n; top_solid_layers = ") != std::string_view::npos && ends_with_setting(gcode) &&
         !has_hole(gcode);
}

ChildCommand command_for(const fs::path& program, const SliceJob& job) {
  ChildCommand command{{program}, {}, job.scratch};
  std::size_t number = 0;
  for (const fs::path& file : job.settings.files) {
    // A copy without the programs that would be run on the G-code: Slic3r has no option for that.
    const fs::path copy = job.scratch / fmt::format("settings-{}.ini", number++);
    write_bytes(plain_settings(read_text(file)), copy);
    command.add({"--load", copy});
  }
  if (job.keep_place) command.add({"--dont-arrange"});
  command.add({"--output", job.gcode, job.model});
  return command;
}

// Slic3r has no supports that are only painted; slicers that come from it say whether others are built.
bool supports_everywhere(std::string_view gcode) {
  const auto supports = setting_in(gcode, "support_material");
  return (supports == "1" || supports == "everywhere") &&  // the latter in 3.0
         setting_in(gcode, "support_material_buildplate_only").value_or("0") == "0" &&
         setting_in(gcode, "support_material_auto").value_or("1") == "1";
}

ChildCommand list_settings(const fs::path& program, const fs::path& file) {
  return {{program, "--save", file}, {}, file.parent_path()};
}

// Slic3r keeps modifiers in AMF alone: volumes of one object, with their settings as metadata.
constexpr const char* kModifier = "slic3r.modifier";
constexpr const char* kInfill = "slic3r.fill_density";

std::string metadata(const char* type, std::string_view value) {
  return fmt::format("<metadata type=\"{}\">{}</metadata>\n", type, value);
}

void append_volume(std::string& out, const Mesh& mesh, const ObjectPart& part) {
  out += "<volume>\n" + metadata("name", part.name);
  if (part.is_modifier) out += metadata(kModifier, "1") + metadata(kInfill, part.infill);
  for (std::size_t i = part.first_triangle; i < part.end(); ++i) {
    const Triangle& t = mesh.triangles[i];
    fmt::format_to(std::back_inserter(out),
                   FMT_COMPILE("<triangle><v1>{}</v1><v2>{}</v2><v3>{}</v3></triangle>\n"), t[0], t[1], t[2]);
  }
  out += "</volume>\n";
}

std::string file_for(const Mesh& mesh, const ObjectPart& model, const ObjectPart& voids,
                     const std::string& object_name) {
  constexpr std::size_t kVertexBytes = 80, kTriangleBytes = 64;
  std::string out;
  out.reserve(mesh.positions.size() * kVertexBytes + mesh.triangles.size() * kTriangleBytes);
  out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<amf unit=\"millimeter\">\n<object id=\"0\">\n" +
        metadata("name", xml_value(object_name.empty() ? model.name : object_name)) + "<mesh>\n<vertices>\n";
  for (const Vec3f& p : mesh.positions)
    fmt::format_to(std::back_inserter(out),
                   FMT_COMPILE("<vertex><coordinates><x>{}</x><y>{}</y><z>{}</z></coordinates></vertex>\n"),
                   Decimal{p.x}, Decimal{p.y}, Decimal{p.z});
  out += "</vertices>\n";
  append_volume(out, mesh, model);
  append_volume(out, mesh, voids);
  return out + "</mesh>\n</object>\n</amf>\n";
}

[[noreturn]] void fail_as_written(const fs::path& file, const std::string& why) {
  throw FailureError(file.string() + ": is not the AMF file that was written: " + why);
}

// <mesh> of such a file, whose document has to stay.
pugi::xml_node read_amf(const fs::path& file, pugi::xml_document& document) {
  const pugi::xml_parse_result result = document.load_file(file.c_str());
  if (!result) fail_as_written(file, result.description());
  return document.child("amf").child("object").child("mesh");
}

std::string metadata_of_type(const pugi::xml_node& volume, const char* type) {
  return volume.find_child_by_attribute("metadata", "type", type).text().as_string();
}

std::vector<ObjectPart> read_parts(const fs::path& file) {
  pugi::xml_document document;
  std::vector<ObjectPart> parts;
  std::size_t next = 0;
  for (const pugi::xml_node volume : read_amf(file, document).children("volume")) {
    const auto triangles = volume.children("triangle");
    const auto count = static_cast<std::size_t>(std::distance(triangles.begin(), triangles.end()));
    parts.push_back({metadata_of_type(volume, "name"), next, count,
                     metadata_of_type(volume, kModifier) == "1", metadata_of_type(volume, kInfill)});
    next += count;
  }
  return parts;
}

Mesh read_mesh(const fs::path& file) {
  pugi::xml_document document;
  const pugi::xml_node mesh_node = read_amf(file, document);
  const auto number = [&](const pugi::xml_node& parent, const char* name) {
    std::string_view text = parent.child(name).text().as_string();
    const auto value = parse_number<float>(text);
    if (!value) fail_as_written(file, fmt::format("<{}>{}</{}>", name, text, name));
    return *value;
  };
  Mesh mesh;
  for (const pugi::xml_node vertex : mesh_node.child("vertices").children("vertex")) {
    const pugi::xml_node at = vertex.child("coordinates");
    mesh.positions.push_back({number(at, "x"), number(at, "y"), number(at, "z")});
  }
  for (const pugi::xml_node volume : mesh_node.children("volume")) {
    for (const pugi::xml_node node : volume.children("triangle")) {
      const Triangle triangle{node.child("v1").text().as_uint(), node.child("v2").text().as_uint(),
                              node.child("v3").text().as_uint()};
      if (std::ranges::max(triangle) >= mesh.positions.size()) fail_as_written(file, "a vertex is missing");
      mesh.triangles.push_back(triangle);
    }
  }
  return mesh;
}

}  // namespace

SlicerProfile slic3r() {
  SlicerProfile row;
  row.name = "slic3r";
  row.family = {"Slic3r"};
  row.programs = {"slic3r", "Slic3r"};
  row.command = command_for;
  row.check_settings = require_setting_lines;
  row.list_settings = list_settings;
  row.is_complete = is_complete;
  row.marks = {"generated by Slic3r"};
  // Slic3r has a line for each extruder, others one line for all. Those of the slicers that come from it included: old versions of these call themselves Slic3r.
  row.figures = {{"filament used [mm]", &GcodeFigures::filament_mm, sum_of},
                 {"filament used [cm3]", &GcodeFigures::filament_cm3, sum_of},
                 {"filament used [g]", &GcodeFigures::filament_g, sum_of},
                 {"filament cost", &GcodeFigures::cost, sum_of, true},
                 {"estimated printing time (normal mode)", &GcodeFigures::seconds, seconds_of},
                 {"filament used", &GcodeFigures::filament_mm, millimetres_of, true},
                 {"filament used", &GcodeFigures::filament_g, grams_of, true},
                 {"filament used", &GcodeFigures::filament_cm3, number_in_brackets, true}};
  row.begins_layer = begins_layer;
  row.supports_everywhere = supports_everywhere;
  row.supports_on_plate = "support_material_buildplate_only = 1";
  row.modifiers = {
      .flavor = "slic3r", .ending = ".amf", .file = file_for, .read = read_parts, .read_mesh = read_mesh};
  return row;
}

}  // namespace aerate
