#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "core/mesh.h"

namespace aerate {

enum class LengthUnit { millimetre, centimetre, metre, inch };

struct LoadOptions {
  // For formats that carry no unit (all but 3MF); 3MF files bring their own and refuse a contradicting one.
  std::optional<LengthUnit> unit;
  double scale = 1.0;
};

struct LoadedModel {
  Mesh mesh;  // all parts of the file, vertices welded where their coordinates are equal, in millimetres
  std::string format;          // "STL", "OBJ", "PLY", "OFF", "3MF"
  std::size_t part_count = 1;  // objects in the file that were joined
  std::size_t vertices_in_file = 0;
};

// Reads STL (binary, ASCII), OBJ, PLY, OFF through assimp and 3MF through lib3mf (unit, components and build
// transforms applied). Triangle order is that of the file; polygons are triangulated.
// Throws InputError (missing, a directory, empty, truncated, wrong triangle count, NaN or infinite
// coordinates, unknown or garbled content), UsageError for a unit that contradicts the file's.
LoadedModel load_model(const std::filesystem::path& path, const LoadOptions& options = {});

}  // namespace aerate
