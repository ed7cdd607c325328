#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "kernels/roof.h"
#include "kernels/vec.h"

// How voids are joined to each other and to the outside, so that resin or powder can run out. Millimetres.

namespace aerate {

// On which sides of a model escape holes may come out, unless their places are given.
struct HoleSides {
  std::vector<Vec3d> on;      // directions (unit) that the surface faces there; none: all
  std::vector<Vec3d> not_on;  // directions that it does not face
  double not_above = std::numeric_limits<double>::infinity();  // heights along `up` as printed
  double not_below = -std::numeric_limits<double>::infinity();
  std::vector<Box3d> not_within;

  bool is_anywhere() const {
    return on.empty() && not_on.empty() && not_within.empty() && not_above > 1e300 && not_below < -1e300;
  }
};

// What is asked of a drainage.
struct DrainageRequest {
  double channel_radius = 0;  // of the channels between voids
  double hole_radius = 0;     // of the escape holes
  // Where there is no place for these, cells get narrower ones; 0: they do not.
  double narrow_hole_radius = 0;
  // Where escape holes are to open, near the surface. Fewer than two are supplemented.
  std::vector<Vec3d> escape_holes;
  HoleSides sides = {};       // of those that supplement them
  bool avoids_plate = false;  // none of these opens onto the build plate
  // Of the height of what is opened, so much is given for a place that does not show at all.
  double worth_of_hiding = 0.25;
  // Holes and windows are added where a layer would close in more than this, mm2.
  double widest_cup = std::numeric_limits<double>::infinity();
};

// A straight round tube about the axis from `start` to `end`.
struct Tube {
  Vec3d start, end;
  double radius = 0;
};

// From its start to its end, unit.
Vec3d direction_of(const Tube& tube);

// A channel between two voids. All of it that is outside the balls lies between its ends.
struct Channel {
  std::uint32_t from = 0, to = 0;
  Tube tube;
};

// What a hole is for.
enum class HolePurpose {
  asked,  // it was asked for there
  drain,  // one of the two that each network needs
  pool,   // more would stay without it than may
  cup,    // a layer of the print would close in more without it than may
};

// A way out of a void. All of it that is outside the ball lies beyond `tube.start`; its axis meets the
// model's surface at `tube.end`.
struct EscapeHole {
  std::uint32_t from = 0;
  Tube tube;
  std::uint32_t network = 0;
  HolePurpose purpose = HolePurpose::drain;
  double shows = 0;  // how much its place shows, 0 to 1 (packing/hole_showing.h)
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
  // What a layer of the print closes in at most, planned, mm2.
  double widest_cup = 0;
};

// Share of its radius by which the side of a tube may pass a ball's centre at most: beyond, their
// intersection runs out at a grazing angle.
inline constexpr double kWidestTubeShare = 0.92;

// More holes and channels are made while more than this share of the voids' volume stays after both
// orientations.
inline constexpr double kPoolsAimedAt = 0.01;

// A hole is cut out of the surface as far beyond it as so many of its radii.
inline constexpr double kCutBeyond = 1.8;

enum class TubeEnd { start, end };

// Two unit vectors which with the tube's axis make a right-handed frame; the first is the side of the tube
// that faces down (any, for an upright tube).
struct TubeFrame {
  Vec3d axis, down, across;
};
TubeFrame frame_of(const Tube& tube, Vec3d up);

// A share of the radius of a tube by which its opening keeps away from those of others on the same ball, and
// from the circle at which a roof begins: more than half the edge of an octagon, so that no edge of one rim
// cuts another.
inline constexpr double kOpeningSpacingShare = 0.4;

// Width, projected along `roof.up`, of the part of a tube's ceiling that leans further than the overhang
// angle: a tube that leans by less has none.
double ceiling_width(const Tube& tube, const Roof& roof);

// Needs no support, or the printer bridges it?
bool is_bridged(const Tube& tube, const Roof& roof);

// Least even number of sides with which an inscribed polygon stays within `tolerance` of a circle; >= 8.
std::size_t tube_sides(double radius, double tolerance);

}  // namespace aerate
