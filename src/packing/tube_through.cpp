#include "packing/tube_through.h"

namespace aerate {

std::optional<Tube> tube_between(const VoidShape& from, const VoidShape& to, Vec3d inside_from,
                                 Vec3d inside_to, double radius) {
  const Tube line{inside_from, inside_to, radius};
  const auto out = from.crossing(line, TubeEnd::start), in = to.crossing(line, TubeEnd::end);
  if (!out || !in) return std::nullopt;
  const Vec3d axis = direction_of(line);
  return Tube{inside_from + axis * out->least, inside_from + axis * in->greatest, radius};
}

std::optional<Tube> tube_into(const VoidShape& to, Vec3d start, Vec3d direction, double radius) {
  const auto in = to.crossing({start, start + direction, radius}, TubeEnd::end);
  if (!in || in->least <= 0) return std::nullopt;
  return Tube{start, start + direction * in->greatest, radius};
}

std::optional<Tube> tube_out_of(const VoidShape& from, Vec3d inside, Vec3d direction, double length,
                                double radius) {
  const auto out = from.crossing({inside, inside + direction, radius}, TubeEnd::start);
  if (!out) return std::nullopt;
  const Vec3d start = inside + direction * out->least;
  return Tube{start, start + direction * length, radius};
}

}  // namespace aerate
