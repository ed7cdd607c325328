#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/annotations.h"
#include "kernels/roof.h"
#include "kernels/roof_distance.h"
#include "kernels/roofed_surface.h"
#include "kernels/vec.h"

// What a packing asks of the shape of its voids, which is a template argument, so that balls do not pay for
// roofs that they do not have. A void is told by a centre and a radius. A shape has
//
//   span(distance, radius)  how far apart voids up to `radius` must be to be no nearer to each other than
//                           balls whose centres are `distance` apart
//   radius_beside(...)      the largest radius of a void at p that keeps the gap to one that is placed
//   constraint_beside(...)  that radius as a function that is easy to work with near p
//   comes_nearer(...)       whether two voids within their span are nearer to each other than the gap
//   box_of_influence(...)   holds every p beside which a placed void leaves a radius of `reach` or less
//   may_touch(...)          whether there may be such a p in a box of cells
//   volume(radius)
//
// and for the surface either kIsBall, which asks how far it is, or the functions that RoofedShape has for it.

namespace aerate::kernels {

struct Ball {
  Vec3d centre;
  double radius;
};

// A value of the clearance with what attains it, as a function that is easy to work with near p:
// |x - centre| - radius.
struct Clearance {
  double value;
  Vec3d centre;
  double radius;
};

struct BallShape {
  static constexpr bool kIsBall = true;

  static BallShape under(const Roof& /*roof*/) { return {}; }
  static double volume(double radius) { return void_volume(Roof{}, radius); }

  AERATE_HD double span(double distance, double /*radius*/) const { return distance; }
  AERATE_HD double radius_beside(Vec3d /*p*/, const Ball& ball, double gap, double distance_squared) const {
    return std::sqrt(distance_squared) - ball.radius - gap;
  }
  AERATE_HD Clearance constraint_beside(Vec3d /*p*/, const Ball& ball, double gap, double value) const {
    return {value, ball.centre, ball.radius + gap};
  }
  AERATE_HD bool comes_nearer(const Ball& /*a*/, const Ball& /*b*/, double /*gap*/) const { return true; }
  AERATE_HD Box3d box_of_influence(const Ball& ball, double gap, double reach) const {
    const double outer = ball.radius + gap + reach;
    const Vec3d half{outer, outer, outer};
    return {ball.centre - half, ball.centre + half};
  }
  AERATE_HD bool may_touch(const Ball& ball, double gap, double reach, double nearest_squared,
                           Vec3d /*middle*/, double /*half_diagonal*/) const {
    const double outer = ball.radius + gap + reach;
    return nearest_squared <= outer * outer;
  }
};

// A ball with the roof that its radius takes (kernels/roof.h).
struct RoofedShape {
  static constexpr bool kIsBall = false;

  Roof roof;

  static RoofedShape under(const Roof& roof) { return {roof}; }
  double volume(double radius) const { return void_volume(roof, radius); }

  // The roof's spine is so much nearer to something than its foot at most.
  AERATE_HD double span(double distance, double radius) const {
    return distance + (1 - roof.sine) * roof.spine(radius);
  }
  AERATE_HD double radius_beside(Vec3d p, const Ball& ball, double gap, double /*distance_squared*/) const {
    return kernels::radius_beside(roof, p, ball.centre, ball.radius, gap).value;
  }
  AERATE_HD Clearance constraint_beside(Vec3d p, const Ball& ball, double gap, double value) const {
    const double height = kernels::radius_beside(roof, p, ball.centre, ball.radius, gap).height;
    return {value, ball.centre - roof.up * height, ball.radius + gap - std::abs(height) * roof.sine};
  }
  AERATE_HD bool comes_nearer(const Ball& a, const Ball& b, double gap) const {
    return distance_between(roof, a.centre, a.radius, b.centre, b.radius) < gap;
  }
  // The own roof reaches up to voids above; roofs of voids up to `reach` reach up to it from below.
  AERATE_HD Box3d box_of_influence(const Ball& ball, double gap, double reach) const {
    Box3d box = BallShape{}.box_of_influence(ball, gap, reach);
    const double outer = ball.radius + gap + reach;
    const double above = roof.spine(ball.radius), below = roof.spine(reach);
    const double upper = outer - above * roof.sine, lower = outer - below * roof.sine;
    const Vec3d top = ball.centre + roof.up * above, bottom = ball.centre - roof.up * below;
    box.lower =
        min_of(box.lower, min_of(top - Vec3d{upper, upper, upper}, bottom - Vec3d{lower, lower, lower}));
    box.upper =
        max_of(box.upper, max_of(top + Vec3d{upper, upper, upper}, bottom + Vec3d{lower, lower, lower}));
    return box;
  }
  // Clearances change by no more than the way from the box's middle.
  AERATE_HD bool may_touch(const Ball& ball, double gap, double reach, double nearest_squared, Vec3d middle,
                           double half_diagonal) const {
    const double half = half_diagonal * (1 + 1e-9);
    // The own roof is above the ball, and roofs of others are below it: the ball alone is beside the rest.
    const double height = dot(middle - ball.centre, roof.up);
    const bool has_roofs = height > -half ? roof.shapes(ball.radius) : false;
    if (!has_roofs && !(height < half && roof.shapes(reach)))
      return BallShape{}.may_touch(ball, gap, reach, nearest_squared, middle, half_diagonal);
    return kernels::radius_beside(roof, middle, ball.centre, ball.radius, gap).value - half <= reach;
  }

  // The largest void at p inside the surface that keeps the wall, given the facet that it touches nearby.
  AERATE_HD WidestVoid widest(const TriangleBvhView& surface, Vec3d p, double wall,
                              std::uint32_t nearby) const {
    if (nearby == kNone) return widest_void(surface, roof, p, wall);
    return narrower(surface, p, wall, {at_facet(surface, p, wall, nearby).value, nearby});
  }
  AERATE_HD WidestVoid narrower(const TriangleBvhView& surface, Vec3d p, double wall,
                                const WidestVoid& best) const {
    return narrower_than(surface, roof, p, wall, best);
  }
  // The largest radius at p that keeps the wall to one facet, and which ball of the void touches then.
  AERATE_HD SpineReach at_facet(const TriangleBvhView& surface, Vec3d p, double wall,
                                std::uint32_t facet) const {
    return radius_within(roof, p, surface.facets[facet], wall);
  }
  AERATE_HD Vec3d rise(double height) const { return roof.up * height; }
  AERATE_HD double fall(double height) const { return height * roof.sine; }
};

}  // namespace aerate::kernels
