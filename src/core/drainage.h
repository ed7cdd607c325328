#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/roof.h"
#include "kernels/sphere.h"
#include "kernels/vec.h"

// How voids are joined to each other and to the outside, so that resin or powder can run out. Millimetres.

namespace aerate {

// What is asked of a drainage.
struct DrainageRequest {
  double channel_radius = 0;  // of the channels between voids
  double hole_radius = 0;     // of the escape holes
  // Where escape holes are to open, near the surface. Fewer than two are supplemented.
  std::vector<Vec3d> escape_holes;
};

// A straight round tube about the axis from `start` to `end`.
struct Tube {
  Vec3d start, end;
  double radius = 0;
};

// A channel between two voids. All of it that is outside the balls lies between its ends.
struct Channel {
  std::uint32_t from = 0, to = 0;
  Tube tube;
};

// A way out of a void. All of it that is outside the ball lies beyond `tube.start`; its axis meets the
// model's surface at `tube.end`.
struct EscapeHole {
  std::uint32_t from = 0;
  Tube tube;
  std::uint32_t network = 0;
};

// Volume that stays, mm3: full voids drain in print orientation, then what is left drains upside down.
struct TrappedPools {
  double upright = 0;      // what stays in print orientation
  double upside_down = 0;  // what would stay of full voids upside down
  double after_both = 0;   // what stays after both, one after the other
  double total = 0;        // voids and channels
};

struct DrainagePlan {
  Roof roof = {};  // of the voids; its `up` is against gravity in print orientation
  std::vector<Channel> channels;
  std::vector<EscapeHole> holes;  // at least two for each network
  std::size_t network_count = 0;  // sets of voids that channels join
  TrappedPools pools;
};

// Share of its radius by which the side of a tube may pass a ball's centre at most: beyond, their
// intersection runs out at a grazing angle.
inline constexpr double kWidestTubeShare = 0.92;

enum class TubeEnd { start, end };

// Two unit vectors which with the tube's axis make a right-handed frame; the first is the side of the tube
// that faces down (any, for an upright tube).
struct TubeFrame {
  Vec3d axis, down, across;
};
TubeFrame frame_of(const Tube& tube, Vec3d up);

// Does the tube meet the ball all round, at a sound angle?
bool meets_all_round(const Tube& tube, const Sphere& ball);

// A share of the radius of a tube by which its opening keeps away from those of others on the same ball, and
// from the circle at which a roof begins: more than half the edge of an octagon, so that no edge of one rim
// cuts another.
inline constexpr double kOpeningSpacingShare = 0.4;

// Does the tube, which meets the ball all round, open into it below the cone of its roof, if it has one, by
// the spacing of openings? The void is convex, so the tube's lines then meet its cone nowhere.
bool opens_below_roof(const Tube& tube, TubeEnd end, const Sphere& ball, const Roof& roof);

// Width, projected along `roof.up`, of the part of a tube's ceiling that leans further than the overhang
// angle: a tube that leans by less has none.
double ceiling_width(const Tube& tube, const Roof& roof);

// Needs no support, or the printer bridges it?
bool is_bridged(const Tube& tube, const Roof& roof);

// The lines of a tube, evenly round its axis, by the angle from its lower side, counter-clockwise.
struct TubeLine {
  double cosine, sine;
};
std::vector<TubeLine> tube_lines(std::size_t sides);

// The rim of a tube's opening into a ball, which it has to meet all round.
class Rim {
 public:
  Rim(const Tube& tube, TubeEnd end, const Sphere& ball, Vec3d up)
      : tube_(tube), end_(end), ball_(ball), frame_(frame_of(tube, up)) {}

  // Where a line of the tube leaves the ball (at the tube's start) or enters it (at its end).
  Vec3d at(TubeLine line) const {
    const Vec3d on_line =
        tube_.start + (frame_.down * line.cosine + frame_.across * line.sine) * tube_.radius;
    const Vec3d from_centre = on_line - ball_.centre;
    const double along = dot(from_centre, frame_.axis);
    const double half_chord =
        std::sqrt(std::max(0.0, ball_.radius * ball_.radius - length_squared(from_centre) + along * along));
    const double t = -along + (end_ == TubeEnd::start ? half_chord : -half_chord);
    return on_line + frame_.axis * t;
  }

 private:
  const Tube& tube_;
  TubeEnd end_;
  const Sphere& ball_;
  TubeFrame frame_;
};

// Points of the rim on `sides` lines. All lie on the sphere; they run counter-clockwise about the axis.
std::vector<Vec3d> ring_on_ball(const Tube& tube, TubeEnd end, const Sphere& ball, Vec3d up,
                                std::size_t sides);

// Least even number of sides with which an inscribed polygon stays within `tolerance` of a circle; >= 8.
std::size_t tube_sides(double radius, double tolerance);

}  // namespace aerate
