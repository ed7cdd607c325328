#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/solid.h"

namespace pugi {
class xml_document;
class xml_node;
}  // namespace pugi

// The parts of an object, of which slicers keep a list beside the model in a 3MF package: <config>, in it
// <object>, in it a node for each part, and in that <metadata key="" value=""/>. (Source: the slicers' own
// readers.)
namespace aerate {

// A setting of a part, as a slicer calls it.
struct PartSetting {
  std::string key, value;

  bool operator==(const PartSetting&) const = default;
};

// Consecutive triangles of a mesh that a slicer treats as one part.
struct ObjectPart {
  std::string name;
  std::size_t first_triangle = 0;
  std::size_t triangle_count = 0;
  bool is_modifier = false;     // not a body, but where the print has this infill instead of its own
  std::string infill;           // "12.5%"; empty for a body
  std::string pattern = {};     // of a modifier, as slicers call it; empty where it is the print's own
  bool blocks_support = false;  // neither, but where no supports are built

  std::vector<PartSetting> settings =
      {};  // of supports, which are a body with these, and need no supports themselves

  std::size_t end() const { return first_triangle + triangle_count; }
  bool operator==(const ObjectPart&) const = default;
};

// A solid's mesh with its void shells turned outward, as bodies of their own, and back.
Mesh with_void_shells_turned(Mesh mesh, const Solid& solid);

// What the part of a file that holds support blockers of voids is called, by which it is known when the file is read.
inline constexpr const char* kSupportBlockers = "no supports in voids";

// What the part of a file that holds supports is called.
inline constexpr const char* kSupports = "supports";

// A model and its supports, the triangles of which come after the model's.
std::vector<ObjectPart> support_parts(std::size_t model_triangles, std::size_t support_triangles,
                                      std::vector<PartSetting> settings);

// What slicers call the infill that grows up like trees, only where it has something to hold.
inline constexpr const char* kLightning = "lightning";

// The parts of such a mesh: the model and one modifier that holds all voids (their shells are disjoint).
std::vector<ObjectPart> modifier_parts(const Solid& solid, double infill_percent,
                                       const std::string& pattern = {});

std::string metadata_of(const pugi::xml_node& node, const char* key);

// Whether a body is supports that this program added: by its name, and since it is filled as these are.
//   pattern_key: what the slicer calls the pattern of infill
bool are_named_supports(const pugi::xml_node& body, const char* pattern_key);

// An entry of a package, empty if there is none.
std::string entry_or_nothing(const std::filesystem::path& package, const char* entry);

// An entry of a package that was written here. Throws FailureError if it is not there or no XML.
pugi::xml_document read_document(const std::filesystem::path& package, const char* entry);

}  // namespace aerate
