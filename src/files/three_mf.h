#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/mesh.h"

namespace aerate {

// The entry of a package that is its model.
inline constexpr const char* kThreeMfModel = "3D/3dmodel.model";

struct ThreeMfEntry {
  std::string name;
  std::string content;
};

// What a program that reads 3MF may want beside a mesh.
struct ThreeMfExtras {
  // If given, the object is put together of components: the mesh is cut into so many triangles each, in
  // order, which become objects 1, 2, ...; the object that is printed comes after them. Else it is object 1.
  std::vector<std::size_t> component_triangles = {};
  // If given, what an object of a component holds before its mesh, as XML, for each of them.
  std::vector<std::string> component_notes = {};
  std::string namespaces = {};             // attributes of the model, for prefixes that these use
  std::string application = "aerate";      // said to have made the package
  std::string object_name = {};            // of the object that is printed, in UTF-8; none if empty
  std::vector<ThreeMfEntry> entries = {};  // further files of the package
};

// Text as an attribute's value: what XML gives a meaning is escaped.
std::string xml_value(std::string_view text);

// A 3MF package in millimetres with one object, for any program that reads 3MF. Decimals read back to the
// same fp32. (The format forbids a triangle to use a vertex twice, and models that are prepared have none.) The
// bytes depend on the arguments alone: no identifiers, dates of 1980.
std::string to_3mf(const Mesh& mesh, const ThreeMfExtras& extras = {});

// The content of one entry, read back from a package. Throws FailureError if it is not there.
std::string read_3mf_entry(const std::filesystem::path& path, const std::string& name);

// The meshes of a package that `to_3mf` made, one for each object that has one, in order. Throws FailureError if there is
// none, InputError for what no package has.
std::vector<Mesh> read_3mf_meshes(const std::filesystem::path& path);

// For a package that is not as `to_3mf` made it.
FailureError not_as_written(const std::filesystem::path& path, const std::string& why);

}  // namespace aerate
