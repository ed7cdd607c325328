#include "core/drainage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aerate {
namespace {

constexpr std::size_t kFewestSides = 8;
constexpr std::size_t kMostSides = 256;

}  // namespace

Vec3d direction_of(const Tube& tube) {
  const Vec3d along = tube.end - tube.start;
  return normalised(along);
}

TubeFrame frame_of(const Tube& tube, Vec3d up) {
  const Vec3d axis = direction_of(tube);
  Vec3d down = axis * dot(axis, up) - up;
  if (length_squared(down) < 1e-12) {
    const bool along_x = std::abs(axis.x) > 0.5;
    const Vec3d other = along_x ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    down = other - axis * dot(axis, other);
  }
  down = normalised(down);
  return {axis, down, cross(axis, down)};
}

double ceiling_width(const Tube& tube, const Roof& roof) {
  const double rise = dot(direction_of(tube), roof.up);
  const double lean = std::sqrt(std::max(0.0, 1 - rise * rise));  // sine of the angle from the vertical
  if (lean <= roof.sine) return 0;
  return 2 * tube.radius * std::sqrt(1 - roof.sine * roof.sine / (lean * lean));
}

bool is_bridged(const Tube& tube, const Roof& roof) {
  return !roof.limits_ceilings() || ceiling_width(tube, roof) <= roof.bridge() * (1 + 1e-9);
}

std::size_t tube_sides(double radius, double tolerance) {
  std::size_t sides = kFewestSides;
  while (sides < kMostSides &&
         radius * (1 - std::cos(std::numbers::pi / static_cast<double>(sides))) > tolerance) {
    sides += 2;
  }
  return sides;
}

}  // namespace aerate
