#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/mesh.h"

namespace pugi {
class xml_node;
}

namespace aerate {

struct InputFile;
struct MeshFormat;

enum class LengthUnit { millimetre, centimetre, metre, inch };

double millimetres_per(LengthUnit unit);

// The triangles of a volume in its object: either those of a component, or a range of its own mesh.
struct VolumeTriangles {
  std::optional<std::uint32_t> component;  // id of the object that it stands for
  std::size_t first = 0, last = 0;
};

// A file of a 3MF package in which a slicer says what the volumes are: <config>, in it <object>s, in them a
// node for each volume, with its name as <metadata key="name" value=""/>.
struct VolumeList {
  const char* entry;
  const char* node;
  // What a volume is that is not part of the model, though in the package it looks like a body of it (a
  // modifier, a negative volume, supports painted as volumes); nothing for a part.
  std::optional<std::string> (*other_kind)(const pugi::xml_node& volume);
  bool (*is_modifier)(const pugi::xml_node& volume);
  VolumeTriangles (*triangles)(const pugi::xml_node& volume);
  // Whether it is such a volume as this program adds to a model, so that the model is as it was without it.
  bool (*is_own)(const pugi::xml_node& volume);
};

struct LoadOptions {
  // For formats that carry no unit; 3MF and glTF files have their own and refuse another.
  std::optional<LengthUnit> unit;
  Vec3d scale{1, 1, 1};  // on top of the unit, along the axes of what is loaded; finite and positive
  // A package that has one of these with a volume that is not part of the model is refused, unless this program added that
  // itself (it is left out), or it is a modifier of one of these names: such are read apart.
  std::vector<VolumeList> volume_lists = {};
  std::vector<std::string> wanted_modifiers = {};
};

// All modifiers of one name, where they are shown.
struct NamedModifier {
  std::string name;
  Mesh mesh;  // as that of the model
};

struct LoadedModel {
  Mesh mesh;  // all parts of the file, vertices welded where their coordinates are equal, in millimetres
  std::string format;                         // "STL", "3MF", ...
  std::size_t part_count = 1;                 // objects in the file that were joined
  std::vector<std::string> notices = {};      // what was left out or mended, in words for the user
  std::vector<NamedModifier> modifiers = {};  // that were asked for and are there
};

// Reads a model of any of the formats in formats.h; the file name's ending (any case) says which. Triangle
// order is that of the file, with degenerate triangles; polygons are triangulated; points and lines are left
// out; components and transforms are applied. Coordinates are converted to millimetres in double and rounded
// once; with unit and scales of 1 they keep the bits of a binary file. (assimp reads decimal text to within one
// unit in the last place.) Throws InputError (missing, a directory, empty, truncated, wrong triangle count,
// NaN or infinite coordinates, unknown or garbled content, no triangles, a volume that is not part of the
// model), UsageError for a unit that contradicts the file's or unusable scales. O(bytes).
LoadedModel load_model(const std::filesystem::path& path, const LoadOptions& options = {});

// As above, of a file that is in memory already.
LoadedModel load_model(InputFile file, const MeshFormat& format, const LoadOptions& options = {});

// A model that its caller has in memory and keeps, by rows.
struct MeshArrays {
  std::span<const double> vertices;         // n x 3, in the unit that LoadOptions say
  std::span<const std::int64_t> triangles;  // m x 3, rows of `vertices`
};

// As above, of arrays as of a file without a unit: coordinates are rounded once, vertices welded and numbered in order of
// first use. `name` stands for the file in messages. Throws InputError for coordinates that are not finite, rows that are not
// there, and no triangles.
LoadedModel load_model(const MeshArrays& arrays, const std::string& name, const LoadOptions& options = {});

}  // namespace aerate
