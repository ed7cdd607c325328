#include "packing/tube_through.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace aerate {
namespace {

// Points of an opening's rim that are looked at; one of them is on the tube's lower side.
constexpr std::size_t kRimPoints = 24;

// Tubes below roofs have this much to spare, mm. Steeper ones (by the sine of the angle from the vertical)
// have no side that they could be moved to.
constexpr double kBesideRoof = 0.01;
constexpr double kLeastLevel = 0.05;

// Least and greatest distance along the axis, from the tube's start, at which its lines cross the sphere.
struct Extent {
  double least, greatest;
};
Extent rim_extent(const Tube& tube, TubeEnd end, const Sphere& ball) {
  // The lines nearest to and farthest from the centre are those towards and away from it.
  const Vec3d axis = (tube.end - tube.start) * (1 / length(tube.end - tube.start));
  const Vec3d to_centre = ball.centre - tube.start;
  const double along = dot(to_centre, axis);
  const double offset = length(to_centre - axis * along);
  const auto half_chord = [&](double distance) {
    return std::sqrt(std::max(0.0, ball.radius * ball.radius - distance * distance));
  };
  const double longest = half_chord(std::max(0.0, offset - tube.radius));
  const double shortest = half_chord(offset + tube.radius);
  return end == TubeEnd::start ? Extent{along + shortest, along + longest}
                               : Extent{along - longest, along - shortest};
}

}  // namespace

std::optional<Tube> tube_between(const Sphere& from, const Sphere& to, Vec3d inside_from, Vec3d inside_to,
                                 double radius) {
  const Tube line{inside_from, inside_to, radius};
  if (!meets_all_round(line, from) || !meets_all_round(line, to)) return std::nullopt;
  const Vec3d axis = (inside_to - inside_from) * (1 / length(inside_to - inside_from));
  const double start = rim_extent(line, TubeEnd::start, from).least;
  const double end = rim_extent(line, TubeEnd::end, to).greatest;
  return Tube{inside_from + axis * start, inside_from + axis * end, radius};
}

std::optional<Tube> tube_into(const Sphere& ball, Vec3d start, Vec3d direction, double radius) {
  const Tube line{start, start + direction, radius};
  if (!meets_all_round(line, ball)) return std::nullopt;
  const Extent rim = rim_extent(line, TubeEnd::end, ball);
  if (rim.least <= 0) return std::nullopt;
  return Tube{start, start + direction * rim.greatest, radius};
}

std::optional<Tube> tube_out_of(const Sphere& ball, Vec3d inside, Vec3d direction, double length,
                                double radius) {
  const Tube line{inside, inside + direction, radius};
  if (!meets_all_round(line, ball)) return std::nullopt;
  const Vec3d start = inside + direction * rim_extent(line, TubeEnd::start, ball).least;
  return Tube{start, start + direction * length, radius};
}

std::optional<WayBelowRoof> way_below_roof(const Sphere& ball, const Roof& roof, Vec3d direction,
                                           double radius) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double rise = dot(direction, roof.up);
  const double level = std::sqrt(std::max(0.0, 1 - rise * rise));
  const bool is_upright = level < kLeastLevel;
  if (is_upright && rise > 0 && roof.shapes(ball.radius)) return std::nullopt;
  if (is_upright || !roof.shapes(ball.radius)) return WayBelowRoof{{0, 0, 0}, kInfinity};
  // The point of the roof's circle in the plane of direction and `up`, as seen along the direction.
  const double circle = ball.radius * (roof.sine * level - roof.cosine * rise);
  return WayBelowRoof{(roof.up - direction * rise) * (1 / level),
                      circle - (1 + kOpeningSpacingShare) * radius - kBesideRoof};
}

double opening_floor(const Tube& tube, TubeEnd end, const Sphere& ball, Vec3d up) {
  const Vec3d axis = (tube.end - tube.start) * (1 / length(tube.end - tube.start));
  const Vec3d lowest = ball.centre - up * ball.radius;
  const Vec3d to_lowest = lowest - tube.start;
  const double side = dot(lowest - ball.centre, axis);
  const bool opens_at_lowest = length(to_lowest - axis * dot(to_lowest, axis)) <= tube.radius &&
                               (end == TubeEnd::start ? side > 0 : side < 0);
  if (opens_at_lowest) return dot(lowest, up);
  static const std::vector<TubeLine> lines = tube_lines(kRimPoints);
  const Rim rim(tube, end, ball, up);
  double floor = std::numeric_limits<double>::infinity();
  for (const TubeLine line : lines) floor = std::min(floor, dot(rim.at(line), up));
  return floor;
}

double sill_of(const Tube& tube, const Sphere& from, const Sphere& to, Vec3d up) {
  return std::max(opening_floor(tube, TubeEnd::start, from, up), opening_floor(tube, TubeEnd::end, to, up));
}

}  // namespace aerate
