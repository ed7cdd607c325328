#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "core/mesh.h"

namespace aerate {

enum class LengthUnit { millimetre, centimetre, metre, inch };

double millimetres_per(LengthUnit unit);

// What is done with a slicer's 3MF project that has modifiers, negative volumes or supports painted as
// volumes: in the package they look like bodies of the model.
enum class OtherVolumes { refuse, take_as_bodies };

struct LoadOptions {
  // For formats that carry no unit; 3MF and glTF files have their own and refuse another.
  std::optional<LengthUnit> unit;
  double scale = 1.0;  // on top of the unit; finite and positive
  OtherVolumes other_volumes = OtherVolumes::refuse;
};

struct LoadedModel {
  Mesh mesh;  // all parts of the file, vertices welded where their coordinates are equal, in millimetres
  std::string format;          // "STL", "3MF", ...
  std::size_t part_count = 1;  // objects in the file that were joined
};

// Reads a model of any of the formats in formats.h; the file name's ending (any case) says which. Triangle
// order is that of the file, with degenerate triangles; polygons are triangulated; points and lines are left
// out; components and transforms are applied. Coordinates are converted to millimetres in double and rounded
// once; with unit and scale 1 they keep the bits of a binary file. (assimp reads decimal text to within one
// unit in the last place.) Throws InputError (missing, a directory, empty, truncated, wrong triangle count,
// NaN or infinite coordinates, unknown or garbled content, no triangles, a slicer's project with modifiers),
// UsageError for a unit that contradicts the file's or an unusable scale. O(bytes).
LoadedModel load_model(const std::filesystem::path& path, const LoadOptions& options = {});

}  // namespace aerate
