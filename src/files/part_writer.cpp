#include "files/part_writer.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "core/error.h"

namespace aerate {
namespace {

// Nine at a time, without a branch for each: 0 x is 0 for finite x only.
bool is_finite(Vec3f a, Vec3f b, Vec3f c) {
  const Vec3f zero = a * 0.0f + b * 0.0f + c * 0.0f;
  return zero.x + zero.y + zero.z == 0.0f;
}

}  // namespace

Vec3d millimetres_per_unit(const LoadOptions& options) {
  return options.scale * millimetres_per(options.unit.value_or(LengthUnit::millimetre));
}

Vec3d millimetres_per_unit(const LoadOptions& options, const UnitOfFile& own, const std::string& name) {
  if (options.unit && millimetres_per(*options.unit) != own.millimetres) {
    throw UsageError(fmt::format("{}: the file says that its unit is the {}", name, own.name),
                     "leave out --unit; --scale changes the size");
  }
  return options.scale * own.millimetres;
}

PartWriter::PartWriter(Welder& welder, const Affine& transform, Vec3d factor, const std::string& name)
    : welder_(welder),
      transform_(transform),
      factor_(factor),
      as_read_(transform.matrix() == Affine::Identity().matrix() && factor == Vec3d{1, 1, 1}),
      mirrored_(transform.linear().determinant() < 0),
      name_(name) {}

Vec3f PartWriter::convert(Vec3f corner) const {
  const Vec3d p = to_double(corner);
  const Eigen::Vector3d moved = transform_ * Eigen::Vector3d(p.x, p.y, p.z);
  return to_float({moved.x() * factor_.x, moved.y() * factor_.y, moved.z() * factor_.z});
}

void PartWriter::add_triangle(Vec3f a, Vec3f b, Vec3f c) {
  if (!is_finite(a, b, c)) fail_not_finite(a, b, c);
  if (!as_read_) {
    a = convert(a);
    b = convert(b);
    c = convert(c);
    if (!is_finite(a, b, c)) fail_too_large();
    if (mirrored_) std::swap(b, c);
  }
  if (welder_.triangle_count() == kMostTriangles) {
    throw InputError(fmt::format("{}: more than {} triangles", name_, welder_.triangle_count()));
  }
  welder_.add_triangle(a, b, c);
}

void PartWriter::fail_not_finite(Vec3f a, Vec3f b, Vec3f c) const {
  throw InputError(
      fmt::format("{}: triangle {} has a coordinate that is NaN or infinite: ({:g}, {:g}, {:g}), "
                  "({:g}, {:g}, {:g}), ({:g}, {:g}, {:g})",
                  name_, welder_.triangle_count() + 1, a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z),
      "export the model again, or repair it in the program that made it");
}

void PartWriter::fail_too_large() const {
  throw InputError(
      fmt::format("{}: triangle {} has a coordinate too large for single precision once it is converted to "
                  "millimetres (by {:g})",
                  name_, welder_.triangle_count() + 1, std::max({factor_.x, factor_.y, factor_.z})),
      "check --unit and --scale");
}

}  // namespace aerate
