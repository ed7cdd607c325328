#include "core/drainage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aerate {
namespace {

Vec3d normalised(Vec3d v) {
  return v * (1 / length(v));
}

constexpr std::size_t kFewestSides = 8;

// Points of an opening's rim that are held against a roof. What is between them is higher by a thousandth of
// the tube's radius at most, which the spacing of openings covers.
constexpr std::size_t kRimPoints = 48;
constexpr std::size_t kMostSides = 256;

}  // namespace

TubeFrame frame_of(const Tube& tube, Vec3d up) {
  const Vec3d axis = normalised(tube.end - tube.start);
  Vec3d down = axis * dot(axis, up) - up;
  if (length_squared(down) < 1e-12) {
    const bool along_x = std::abs(axis.x) > 0.5;
    const Vec3d other = along_x ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    down = other - axis * dot(axis, other);
  }
  down = normalised(down);
  return {axis, down, cross(axis, down)};
}

bool meets_all_round(const Tube& tube, const Sphere& ball) {
  const Vec3d axis = normalised(tube.end - tube.start);
  const Vec3d to_start = tube.start - ball.centre;
  const Vec3d offset = to_start - axis * dot(to_start, axis);
  return length(offset) + tube.radius <= kWidestTubeShare * ball.radius;
}

bool opens_below_roof(const Tube& tube, TubeEnd end, const Sphere& ball, const Roof& roof) {
  if (!roof.shapes(ball.radius)) return true;
  const double shoulder = roof.shoulder(ball.radius), aside = ball.radius * roof.cosine;
  const double spacing = kOpeningSpacingShare * tube.radius;
  static const std::vector<TubeLine> lines = tube_lines(kRimPoints);
  const Rim rim(tube, end, ball, roof.up);
  for (const TubeLine line : lines) {
    const Vec3d offset = rim.at(line) - ball.centre;
    const double height = dot(offset, roof.up);
    if (height >= shoulder) return false;
    // Distance from the point of the circle above or below it.
    if (std::hypot(length(offset - roof.up * height) - aside, shoulder - height) < spacing) return false;
  }
  return true;
}

double ceiling_width(const Tube& tube, const Roof& roof) {
  const double rise = dot(normalised(tube.end - tube.start), roof.up);
  const double lean = std::sqrt(std::max(0.0, 1 - rise * rise));  // sine of the angle from the vertical
  if (lean <= roof.sine) return 0;
  return 2 * tube.radius * std::sqrt(1 - roof.sine * roof.sine / (lean * lean));
}

bool is_bridged(const Tube& tube, const Roof& roof) {
  return !roof.limits_ceilings() || ceiling_width(tube, roof) <= roof.bridge() * (1 + 1e-9);
}

std::vector<TubeLine> tube_lines(std::size_t sides) {
  std::vector<TubeLine> lines;
  lines.reserve(sides);
  for (std::size_t i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(sides);
    lines.push_back({std::cos(angle), std::sin(angle)});
  }
  return lines;
}

std::vector<Vec3d> ring_on_ball(const Tube& tube, TubeEnd end, const Sphere& ball, Vec3d up,
                                std::size_t sides) {
  const Rim rim(tube, end, ball, up);
  std::vector<Vec3d> ring;
  ring.reserve(sides);
  for (const TubeLine line : tube_lines(sides)) ring.push_back(rim.at(line));
  return ring;
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
