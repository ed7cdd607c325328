#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kernels/cell_planes.h"
#include "kernels/roof.h"
#include "printing/cells/cell_nodes.h"
#include "printing/cells/cell_region.h"

// Roofs of cells. A ceiling is what is above a void; where it leans out of the vertical by no more than the
// overhang angle it carries itself, and where it is no wider than the bridge the printer spans it. A cell's own
// ceilings are planes of its packing and the model's surface, of any slope. Under those that are too flat a roof
// is put: planes that lean by just the overhang angle, which meet in a ridge or a flat top that can be bridged.
// The room below a roof is convex, so that no solid hangs from it into the void.

namespace aerate {

// A place where a ball that a piece is opened by touches a ceiling that is too flat: the ball's centre. Ball
// centres reach as far as the void does less the ball.
struct FlatCeiling {
  Vec3d centre;
};

// Those of a piece (`labels` of nodes, `piece`): ceilings as wide as the flat top of a roof may be, or as `share` of
// that, are left out. In the order of nodes.
std::vector<FlatCeiling> flat_ceilings(const CellRegion& region, const CellNodes& nodes,
                                       const std::vector<std::int32_t>& labels, std::int32_t piece,
                                       const Roof& roof, double share, SharedWork& work);

// Planes that keep a piece below all of `ceilings` and leave as much of it as was found: of roofs with eight
// sides, under many places, each with its sides moved out as far as the ceilings allow. Their neighbour is kNone.
// Empty if no roof leaves anything.
std::vector<CellPlane> roof_below(std::span<const FlatCeiling> ceilings, const CellNodes& nodes,
                                  const std::vector<std::int32_t>& labels, std::int32_t piece,
                                  const Roof& roof);

}  // namespace aerate
