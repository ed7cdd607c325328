#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/drainage.h"
#include "core/void_shape.h"
#include "kernels/constants.h"

// Where liquid stays in drained voids. It is at rest, flows slowly, and leaves a void through the lowest
// point of an opening: the spill height of a void is the least height, over all ways out, of the highest sill
// on the way, found for all voids at once by a flood in order of height (priority flood; Barnes, Lehman and
// Mulla, "Priority-flood", 2014). What lies below it stays.

namespace aerate {

// How liquid runs out in one orientation.
struct SpillHeights {
  std::vector<double> height;          // along `up`, by void; infinite if nothing leads out
  std::vector<std::uint32_t> towards;  // the void that it spills into, or kNone
  std::vector<std::uint32_t> order;    // the voids that drain, those after their `towards`
  // By channel: the heights above which it takes liquid in at its start and at its end.
  std::vector<std::array<double, 2>> floors;
};
SpillHeights spill_heights(std::span<const VoidShape> voids, const DrainagePlan& plan, Vec3d up);

// Height that liquid has to reach to pass from one void to the other through a tube, in either direction.
double sill_of(const Tube& tube, const VoidShape& from, const VoidShape& to, Vec3d up);

// The same to leave through an escape hole.
double sill_of_hole(const EscapeHole& hole, const VoidShape& from, Vec3d up);

// What stays in print orientation in voids that are one basin: of one spill height along a way out.
struct Pool {
  double volume = 0;  // mm3
  std::vector<std::uint32_t> voids;
};

// The largest first.
std::vector<Pool> upright_pools(std::span<const VoidShape> voids, const DrainagePlan& plan);

// A branch is a void with all that drains through it; each comes after the void that it drains into.
std::vector<std::uint32_t> branch_of(std::uint32_t root, const SpillHeights& spills);

// The root of the branch of which the largest share stays full in print orientation, more than `least`, where
// the spill heights are `spills`; one with an escape hole only if there is no other, and one that holds any
// of the voids `kept` never. kNone if there is none.
std::uint32_t fullest_branch(std::span<const VoidShape> voids, const DrainagePlan& plan,
                             const SpillHeights& spills, std::span<const std::uint32_t> kept, double least);

// What stays in full voids in print orientation, and of that after they have been turned upside down. The
// latter is an upper bound: what a pool loses runs down its way out and fills what it meets there; what stays
// in a channel is counted at both of its ends.
TrappedPools trapped_pools(std::span<const VoidShape> voids, const DrainagePlan& plan);

// Of a void below its spill height, seen from above, the widest of all: what a layer of the print closes in, mm2.
double widest_cup(std::span<const VoidShape> voids, const DrainagePlan& plan);

}  // namespace aerate
