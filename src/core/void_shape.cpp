#include "core/void_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernels/point_triangle.h"
#include "kernels/roof_distance.h"

namespace aerate {
namespace {

// Points of an opening's rim of which the lowest is taken; one of them is on the tube's lower side.
constexpr std::size_t kFloorPoints = 24;

// Points of an opening's rim that are held against a roof. What is between them is higher by a thousandth of
// the tube's radius at most, which the spacing of openings covers.
constexpr std::size_t kRoofPoints = 48;

// Tubes below roofs have this much to spare, mm. Steeper ones (by the sine of the angle from the vertical)
// have no side that they could be moved to.
constexpr double kBesideRoof = 0.01;
constexpr double kLeastLevel = 0.05;

// A tube wider than this share of the shoulder would leave hardly any cone below it.
constexpr double kWidestTopShare = 0.9;

// How far the ends of a tube out of the top may be off its axis, mm.
constexpr double kOnAxis = 1e-6;

// The lines of a tube, evenly round its axis, by the angle from its lower side.
struct TubeLine {
  double cosine, sine;
};

std::vector<TubeLine> tube_lines(std::size_t sides) {
  std::vector<TubeLine> lines;
  lines.reserve(sides);
  for (std::size_t i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(sides);
    lines.push_back({std::cos(angle), std::sin(angle)});
  }
  return lines;
}

// Where lines of a tube leave a ball (at the tube's start) or enter it (at its end): the rim of its opening.
std::vector<Vec3d> rim_on(const Sphere& ball, const Tube& tube, TubeEnd end, Vec3d up,
                          std::span<const TubeLine> lines) {
  const TubeFrame frame = frame_of(tube, up);
  std::vector<Vec3d> rim;
  rim.reserve(lines.size());
  for (const TubeLine line : lines) {
    const Vec3d on_line = tube.start + (frame.down * line.cosine + frame.across * line.sine) * tube.radius;
    const Vec3d from_centre = on_line - ball.centre;
    const double along = dot(from_centre, frame.axis);
    const double half_chord =
        std::sqrt(std::max(0.0, ball.radius * ball.radius - length_squared(from_centre) + along * along));
    rim.push_back(on_line + frame.axis * (-along + (end == TubeEnd::start ? half_chord : -half_chord)));
  }
  return rim;
}

// Of a ball, up to a height above its lowest point.
double cap_volume(double radius, double depth) {
  depth = std::clamp(depth, 0.0, 2 * radius);
  return std::numbers::pi * depth * depth * (3 * radius - depth) / 3;
}

}  // namespace

// Up to a height above the centre: of the ball up to the shoulder, then of the cone.
double VoidShape::volume_up_to(double height) const {
  const double radius = ball_.radius, shoulder = roof_.shoulder(radius);
  const double of_ball = cap_volume(radius, radius + std::min(height, shoulder));
  const double rise = std::min(height, roof_.top(radius)) - shoulder;
  if (rise <= 0) return of_ball;
  const double wide = radius * roof_.cosine;
  const double narrow = wide - rise * roof_.sine / roof_.cosine;
  return of_ball + std::numbers::pi / 3 * rise * (wide * wide + wide * narrow + narrow * narrow);
}

double VoidShape::volume_below(Vec3d up, double height) const {
  const double above_centre = height - dot(ball_.centre, up);
  if (!has_roof()) return cap_volume(ball_.radius, ball_.radius + above_centre);
  if (dot(up, roof_.up) > 0) return volume_up_to(above_centre);
  return volume() - volume_up_to(-above_centre);
}

// The room is a union of balls on the spine. Distance along a line to a convex set is a convex function, the
// balls' radii fall evenly, so the least difference is found by thirds.
double VoidShape::distance_to(const Segment& segment) const {
  const auto from_ball = [&](double height) {
    return distance_to_point(segment, ball_.centre + roof_.up * height) - ball_.radius + height * roof_.sine;
  };
  double low = 0, high = reach_beyond_ball();
  double nearest = std::min(from_ball(low), from_ball(high));
  for (const double precision = 1e-9 * high; high - low > precision;) {
    const double third = (high - low) / 3;
    const double lower = from_ball(low + third), upper = from_ball(high - third);
    nearest = std::min({nearest, lower, upper});
    if (lower <= upper) high -= third;
    if (upper <= lower) low += third;
  }
  return nearest;
}

bool VoidShape::is_farther_than(double distance, const Segment& segment) const {
  const double from_ball = distance_to_point(segment, ball_.centre) - ball_.radius;
  const double spine = reach_beyond_ball();
  if (from_ball < distance || spine == 0) return from_ball >= distance;
  return from_ball >= distance + spine || distance_to(segment) >= distance;
}

double VoidShape::least_radius_holding(Vec3d p) const {
  const double with_roof = has_roof() ? aerate::least_radius_holding(roof_, ball_.centre, p) : 0;
  return roof_.shapes(with_roof) ? with_roof : length(p - ball_.centre);
}

double VoidShape::depth(const kernels::Facet& facet) const {
  if (!has_roof()) return ball_.radius - std::sqrt(kernels::distance_squared_to_facet(ball_.centre, facet));
  double lowest = roof_.top(ball_.radius);
  for (int i = 0; i < 3; ++i)
    lowest = std::min(lowest, dot(to_double(facet.corner(i)) - ball_.centre, roof_.up));
  return std::min(roof_.top(ball_.radius) - lowest,
                  kernels::lateral_depth(roof_, ball_.centre, ball_.radius, facet));
}

double VoidShape::volume_within(double tolerance) const {
  const double nearest = std::min(ball_.radius, roof_.top(ball_.radius));
  const double scale = std::max(0.0, 1 - tolerance / nearest);
  return volume() * scale * scale * scale;
}

// The lines nearest to and farthest from the centre are those towards and away from it.
std::optional<Crossing> VoidShape::crossing(const Tube& tube, TubeEnd end) const {
  const Vec3d axis = direction_of(tube);
  const Vec3d to_centre = ball_.centre - tube.start;
  const double along = dot(to_centre, axis);
  const double offset = length(to_centre - axis * along);
  if (!takes_tube(offset + tube.radius)) return std::nullopt;
  const auto half_chord = [&](double distance) {
    return std::sqrt(std::max(0.0, ball_.radius * ball_.radius - distance * distance));
  };
  const double longest = half_chord(std::max(0.0, offset - tube.radius));
  const double shortest = half_chord(offset + tube.radius);
  return end == TubeEnd::start ? Crossing{along + shortest, along + longest}
                               : Crossing{along - longest, along - shortest};
}

bool VoidShape::opens_below_roof(const Tube& tube, TubeEnd end) const {
  if (!has_roof()) return true;
  const double shoulder = roof_.shoulder(ball_.radius), aside = ball_.radius * roof_.cosine;
  const double spacing = kOpeningSpacingShare * tube.radius;
  static const std::vector<TubeLine> lines = tube_lines(kRoofPoints);
  const std::vector<Vec3d> rim = rim_on(ball_, tube, end, roof_.up, lines);
  return std::all_of(rim.begin(), rim.end(), [&](Vec3d p) {
    const Vec3d offset = p - ball_.centre;
    const double height = dot(offset, roof_.up);
    // And distance from the point of the circle above it.
    return height < shoulder &&
           std::hypot(length(offset - roof_.up * height) - aside, shoulder - height) >= spacing;
  });
}

std::optional<WayBelowRoof> VoidShape::way_below_roof(Vec3d direction, double radius) const {
  const double rise = dot(direction, roof_.up);
  const double level = std::sqrt(std::max(0.0, 1 - rise * rise));
  const bool is_upright = level < kLeastLevel;
  if (is_upright && rise > 0 && has_roof()) return std::nullopt;
  if (is_upright || !has_roof()) return WayBelowRoof{{0, 0, 0}, std::numeric_limits<double>::infinity()};
  // The point of the roof's circle in the plane of direction and `up`, as seen along the direction.
  const double circle = ball_.radius * (roof_.sine * level - roof_.cosine * rise);
  return WayBelowRoof{(roof_.up - direction * rise) * (1 / level),
                      circle - (1 + kOpeningSpacingShare) * radius - kBesideRoof};
}

bool VoidShape::has_top_for(double tube_radius) const {
  return has_roof() && tube_radius >= roof_.flat_radius() &&
         tube_radius <= kWidestTopShare * ball_.radius * roof_.cosine;
}

bool VoidShape::comes_out_of_top(const Tube& tube) const {
  if (!has_top_for(tube.radius)) return false;
  const auto is_on_axis = [&](Vec3d p) {
    const Vec3d offset = p - ball_.centre;
    return length(offset - roof_.up * dot(offset, roof_.up)) < kOnAxis;
  };
  const double start = dot(tube.start - ball_.centre, roof_.up);
  return is_on_axis(tube.start) && is_on_axis(tube.end) && dot(tube.end - tube.start, roof_.up) > 0 &&
         std::abs(start - top_opening_height(tube.radius)) < kOnAxis;
}

double VoidShape::opening_floor(const Tube& tube, TubeEnd end, Vec3d up) const {
  const Vec3d axis = direction_of(tube);
  const Vec3d lowest = ball_.centre - up * ball_.radius;
  const Vec3d to_lowest = lowest - tube.start;
  const double side = dot(lowest - ball_.centre, axis);
  const bool opens_at_lowest = length(to_lowest - axis * dot(to_lowest, axis)) <= tube.radius &&
                               (end == TubeEnd::start ? side > 0 : side < 0);
  if (opens_at_lowest) return dot(lowest, up);
  static const std::vector<TubeLine> lines = tube_lines(kFloorPoints);
  double floor = std::numeric_limits<double>::infinity();
  for (const Vec3d p : rim_on(ball_, tube, end, up, lines)) floor = std::min(floor, dot(p, up));
  return floor;
}

std::vector<Vec3d> VoidShape::rim(const Tube& tube, TubeEnd end, std::size_t sides) const {
  return rim_on(ball_, tube, end, roof_.up, tube_lines(sides));
}

std::vector<VoidShape> shapes_of(std::span<const Sphere> spheres, const Roof& roof) {
  std::vector<VoidShape> shapes;
  shapes.reserve(spheres.size());
  for (const Sphere& sphere : spheres) shapes.emplace_back(sphere, roof);
  return shapes;
}

}  // namespace aerate
