#pragma once

#include <fmt/format.h>
#include <string>

#include "core/mesh.h"

// The model part of a 3MF package, piece by piece.
namespace aerate::test {

inline constexpr const char* kThreeMfCore = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";

inline std::string mesh_xml(const Mesh& mesh, const std::string& beside = "") {
  std::string xml = "<mesh><vertices>";
  for (const Vec3f p : mesh.positions) xml += fmt::format(R"(<vertex x="{}" y="{}" z="{}"/>)", p.x, p.y, p.z);
  xml += "</vertices><triangles>";
  for (const Triangle& t : mesh.triangles)
    xml += fmt::format(R"(<triangle v1="{}" v2="{}" v3="{}"/>)", t[0], t[1], t[2]);
  return xml + "</triangles>" + beside + "</mesh>";
}

inline std::string object_xml(int id, const std::string& content, const std::string& attributes = "") {
  return fmt::format(R"(<object id="{}" {}>{}</object>)", id, attributes, content);
}

inline std::string item_xml(int id, const std::string& attributes = "") {
  return fmt::format(R"(<item objectid="{}" {}/>)", id, attributes);
}

// Without a unit if that is empty.
inline std::string model_xml(const std::string& objects, const std::string& items,
                             const std::string& attributes = "", const std::string& unit = "millimeter") {
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<model {} xmlns="{}" {}>
<resources>{}</resources>
<build>{}</build>
</model>)",
                     unit.empty() ? "" : fmt::format(R"(unit="{}")", unit), kThreeMfCore, attributes, objects,
                     items);
}

}  // namespace aerate::test
