#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/packing.h"
#include "kernels/vec.h"

namespace aerate {

struct InputFile;

// Spheres as a file, millimetres in the model's own coordinates; each number in the shortest form that reads
// back to the same fp64.
struct SphereFormat {
  const char* ending;
  const char* program;  // that reads it, if it is for one
  // `model`: the box of the model that they were packed in
  std::string (*write)(const std::vector<Sphere>& spheres, const Box3f& model);
  std::vector<Sphere> (*read)(const InputFile& file);  // null for a format that is only written

  // A line "x,y,z,radius,kind", then one line a sphere.
  static const SphereFormat csv;
  // {"schema": "aerate.spheres", "schema_version": 1, "unit": "mm", "spheres": [[x, y, z, radius, kind],
  // ...]}
  static const SphereFormat json;
  // Text; one vertex a sphere, properties x, y, z, radius (double) and kind (uchar, the order of SphereKind).
  static const SphereFormat ply;
  // For programs that simulate grains: see grain_tables.h.
  static const SphereFormat vtk, lammps, yade;
};

// For sentences: ".csv, .json, .ply, .vtp (ParaView), .data (LAMMPS) or .txt (YADE)", of all that are written.
std::string endings_of_sphere_tables();

// From the file name's ending (any case), if it is one of these.
std::optional<SphereFormat> find_sphere_format(const std::filesystem::path& path);

// The same. Throws UsageError for another ending.
SphereFormat sphere_format_to_write(const std::filesystem::path& path);

std::string sphere_table(const Packing& packing, const SphereFormat& format, const Box3f& model);

// Reads any of the first three; `kind` may be missing in a csv or json file (then it is `adaptive`). Throws
// UsageError for another ending, InputError, naming the line or the number of the sphere, for a missing file, other content, numbers that
// are not finite, and radii that are not positive.
std::vector<Sphere> read_sphere_table(const std::filesystem::path& path);

// "lattice", "interstice", ...
const char* name_of(SphereKind kind);

}  // namespace aerate
