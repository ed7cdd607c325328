#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>

#include "files/file_check.h"
#include "files/load.h"
#include "files/weld.h"

namespace aerate {

// x -> A x + b, of a file's nodes, components and build items.
using Affine = Eigen::Transform<double, 3, Eigen::AffineCompact>;

// What the library that understands a format gives: millimetres, triangles in the order of the file, welded.
struct ImportedModel {
  Mesh mesh;
  std::size_t part_count = 0;
  std::size_t vertices_in_file = 0;
};

// Through assimp. `extension` is lower case without its dot ("stl", "obj", "ply", "off"); `factor` converts a
// coordinate to millimetres. Throws InputError for what assimp refuses, for coordinates that are not finite,
// and where its result does not hold what the file says (`facts`).
ImportedModel import_with_assimp(const FileBytes& bytes, const std::string& extension, const FileFacts& facts,
                                 double factor, const std::string& name);
ImportedModel import_with_assimp(const std::filesystem::path& path, const FileFacts& facts, double factor);

// Through lib3mf: the build items with their components, each transformed. `scale` is applied on top of the
// file's own unit. Throws InputError as above; UsageError if `unit` is given and is not the file's.
ImportedModel import_3mf(FileBytes& bytes, std::optional<LengthUnit> unit, double scale,
                         const std::string& name);

// Hands triangles of a part to the welder: transformed in double, converted to millimetres and rounded
// once; a part that is neither moved nor converted keeps its bits. A mirrored part is turned right side out.
class PartWriter {
 public:
  PartWriter(Welder& welder, const Affine& transform, double factor, const std::string& name);

  // Corners as in the file. Throws InputError if one is not finite, before or after conversion.
  void add_triangle(Vec3f a, Vec3f b, Vec3f c);

 private:
  Vec3f convert(Vec3f corner) const;
  [[noreturn]] void fail_not_finite(Vec3f a, Vec3f b, Vec3f c) const;
  [[noreturn]] void fail_too_large() const;

  Welder& welder_;
  Affine transform_;
  double factor_;
  bool as_read_;
  bool mirrored_;
  const std::string& name_;
};

}  // namespace aerate
