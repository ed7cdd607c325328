#pragma once

#include <span>
#include <vector>

#include "core/drainage.h"
#include "kernels/vec.h"
#include "packing/tube_clearance.h"

namespace aerate {

// Does a hole open onto a build plate at this height along `up`?
bool opens_onto_plate(const Tube& hole, Vec3d up, double plate);

// Where on the outside of a model an escape hole may come out, and how much it would be seen there.
class HoleShowing {
 public:
  // `up`: against gravity as printed; `plate`: the height along it of the model's lowest point, -infinity if there is no
  // build plate. The clearance must outlive this.
  HoleShowing(const TubeClearance& clearance, Vec3d up, double plate, const DrainageRequest& request);

  // Does the request allow a hole where this one meets the surface, with all of its rim?
  bool is_allowed(const Tube& hole) const;
  // The two reasons why it may not.
  bool reaches_plate(const Tube& hole) const;
  bool is_on_sides(const Tube& hole) const;

  // How much the place shows, 0 to 1: the share of what a lamp at each direction of view would give it that the model does not
  // keep off (ambient exposure, by rays). Views from below count a third, and all of them a little less from the back
  // (+y where up is +z), so that of two like places the one at the back is taken.
  double of(const Tube& hole) const;

 private:
  // Places on the surface where lines of the hole's side leave it.
  std::vector<Vec3d> rim_of(const Tube& hole) const;
  bool is_on_allowed_side(Vec3d place) const;

  const TubeClearance& clearance_;
  Vec3d up_, back_;
  double plate_;
  const DrainageRequest& request_;
  std::vector<Vec3d> views_;  // evenly over the unit sphere
};

// Says of the holes of a plan how much they show and what they are for: those at places that were asked for; the first two
// of each network; and what was added to these for pools, unless that says that it is for a cup.
void describe_holes(std::vector<EscapeHole>& holes, const DrainageRequest& request,
                    const HoleShowing& showing);

}  // namespace aerate
