#include "printing/slicers/object_parts.h"

#include <fmt/format.h>
#include <pugixml.hpp>
#include <utility>

#include "files/three_mf.h"

namespace aerate {

Mesh with_void_shells_turned(Mesh mesh, const Solid& solid) {
  for (std::size_t i = solid.outer_triangle_count(); i < mesh.triangles.size(); ++i)
    std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
  return mesh;
}

std::vector<ObjectPart> modifier_parts(const Solid& solid, double infill_percent,
                                       const std::string& pattern) {
  const std::size_t outer = solid.outer_triangle_count();
  return {{"model", 0, outer, false, ""},
          {"voids", outer, solid.mesh.triangles.size() - outer, true, fmt::format("{}%", infill_percent),
           pattern}};
}

std::vector<ObjectPart> support_parts(std::size_t model_triangles, std::size_t support_triangles,
                                      std::vector<PartSetting> settings) {
  ObjectPart supports{kSupports, model_triangles, support_triangles, false, ""};
  supports.settings = std::move(settings);
  return {{"model", 0, model_triangles, false, ""}, supports};
}

std::string metadata_of(const pugi::xml_node& node, const char* key) {
  return node.find_child_by_attribute("metadata", "key", key).attribute("value").as_string();
}

bool are_named_supports(const pugi::xml_node& body, const char* pattern_key) {
  return metadata_of(body, "name") == kSupports && metadata_of(body, pattern_key) == kLightning;
}

std::string entry_or_nothing(const std::filesystem::path& package, const char* entry) {
  try {
    return read_3mf_entry(package, entry);
  } catch (const FailureError&) {
    return "";
  }
}

pugi::xml_document read_document(const std::filesystem::path& package, const char* entry) {
  const std::string content = read_3mf_entry(package, entry);
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(content.data(), content.size());
  if (!result) throw not_as_written(package, std::string(entry) + ": " + result.description());
  return document;
}

}  // namespace aerate
