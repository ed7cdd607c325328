#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/drainage.h"
#include "core/segment_distance.h"
#include "kernels/facet.h"
#include "kernels/roof.h"
#include "kernels/sphere.h"
#include "kernels/vec.h"

namespace aerate {

// A tube that leaves a void with a roof has to do so below it. `across` is the direction that rises most of
// those at right angles to the tube's, and `highest` the farthest along it, from the void's centre, that its
// axis may pass; infinite where nothing limits it.
struct WayBelowRoof {
  Vec3d across;
  double highest;
};

// Least and greatest distance along a tube's axis, from its start, at which its lines cross a surface.
struct Crossing {
  double least, greatest;
};

// The planned shape of one void, and all that the host asks about it: what it holds, how far it is from
// something, and how tubes open into it. It is a ball with the roof that its radius takes (kernels/roof.h);
// `up` below is `roof.up` or the opposite. It is convex. Millimetres, fp64.
class VoidShape {
 public:
  VoidShape(const Sphere& planned, const Roof& roof) : ball_(planned), roof_(roof) {}

  Vec3d centre() const { return ball_.centre; }
  // Of the ball round its centre.
  double radius() const { return ball_.radius; }
  bool has_roof() const { return roof_.shapes(ball_.radius); }
  // Height along `up` of the lowest point of the ball.
  double bottom(Vec3d up) const { return dot(ball_.centre, up) - ball_.radius; }

  double volume() const { return void_volume(roof_, ball_.radius); }
  // Of what lies below a height along `up`, mm3.
  double volume_below(Vec3d up, double height) const;

  // How far the room that is kept for it (kernels/roof.h) reaches beyond the ball at most.
  double reach_beyond_ball() const { return roof_.spine(ball_.radius); }
  // From that room; negative where they overlap. To 1e-9 of the spine's length.
  double distance_to(const Segment& segment) const;
  bool is_farther_than(double distance, const Segment& segment) const;

  // The least radius with which the void, with the roof that it then takes, holds a point.
  double least_radius_holding(Vec3d p) const;
  // How deep inside the void a facet lies at its deepest; where there is a roof, at most.
  double depth(const kernels::Facet& facet) const;
  // The least volume where the surface is up to `tolerance` inside: of the void scaled about its centre,
  // which is that far from its nearest side.
  double volume_within(double tolerance) const;

  // Is it wide enough for tubes of this radius?
  bool takes_tube(double radius) const { return radius <= kWidestTubeShare * ball_.radius; }

  // Where a tube leaves the ball (at its start) or enters it (at its end); nullopt unless it meets the ball
  // all round, at a sound angle.
  std::optional<Crossing> crossing(const Tube& tube, TubeEnd end) const;

  // Does the tube, which meets the ball all round, open into it below the cone of the roof, if there is one,
  // by the spacing of openings? The tube's lines then meet the cone nowhere.
  bool opens_below_roof(const Tube& tube, TubeEnd end) const;

  // Where a tube in this direction (unit) opens below the roof; nullopt for a tube straight up, which has no
  // such side.
  std::optional<WayBelowRoof> way_below_roof(Vec3d direction, double radius) const;

  // A tube may also come straight out of the top of a roof, unless it is too wide for the cone or narrower
  // than the flat top: the cone ends where it is as wide as the tube, which takes the place of the flat top.
  bool has_top_for(double tube_radius) const;
  // That place's height above the centre.
  double top_opening_height(double tube_radius) const {
    return (ball_.radius - tube_radius * roof_.cosine) / roof_.sine;
  }
  // Does the tube start there? It then runs along `roof.up` through the centre.
  bool comes_out_of_top(const Tube& tube) const;

  // Does the tube open into the void in one of these two ways?
  bool may_open(const Tube& tube, TubeEnd end) const {
    return opens_below_roof(tube, end) || (end == TubeEnd::start && comes_out_of_top(tube));
  }

  // Height along `up` above which liquid leaves through the tube: the lowest point of its opening.
  double opening_floor(const Tube& tube, TubeEnd end, Vec3d up) const;

  // Points of the rim of the tube's opening into the ball, evenly round its axis from its lower side,
  // counter-clockwise.
  std::vector<Vec3d> rim(const Tube& tube, TubeEnd end, std::size_t sides) const;

 private:
  double volume_up_to(double height) const;

  Sphere ball_;
  Roof roof_;
};

std::vector<VoidShape> shapes_of(std::span<const Sphere> spheres, const Roof& roof);

}  // namespace aerate
