#pragma once

#include <Eigen/Geometry>
#include <string>

#include "files/load.h"
#include "files/weld.h"

namespace aerate {

// x -> A x + b, of a file's nodes, components and build items.
using Affine = Eigen::Transform<double, 3, Eigen::AffineCompact>;

// Millimetres for coordinates of 1 in a file that does not say its unit.
Vec3d millimetres_per_unit(const LoadOptions& options);

// In a file that does. Throws UsageError if the options have another unit; `name` is the file's.
struct UnitOfFile {
  const char* name;
  double millimetres;
};
Vec3d millimetres_per_unit(const LoadOptions& options, const UnitOfFile& own, const std::string& name);

// Hands triangles of a part to the welder: transformed in double, converted to millimetres and rounded
// once; a part that is neither moved nor converted keeps its bits. A mirrored part is turned right side out.
class PartWriter {
 public:
  // `factor`: millimetres for a unit of the file along each axis, after the transform. `name`: the file's, for messages.
  PartWriter(Welder& welder, const Affine& transform, Vec3d factor, const std::string& name);

  // Corners as in the file. Throws InputError if one is not finite, before or after conversion.
  void add_triangle(Vec3f a, Vec3f b, Vec3f c);

 private:
  Vec3f convert(Vec3f corner) const;
  [[noreturn]] void fail_not_finite(Vec3f a, Vec3f b, Vec3f c) const;
  [[noreturn]] void fail_too_large() const;

  Welder& welder_;
  Affine transform_;
  Vec3d factor_;
  bool as_read_;
  bool mirrored_;
  const std::string& name_;
};

}  // namespace aerate
