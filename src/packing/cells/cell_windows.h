#pragma once

#include <cstdint>
#include <vector>

#include "core/cells.h"
#include "core/drainage.h"
#include "core/monitor.h"
#include "core/packing.h"
#include "packing/cells/cell_drainage_pools.h"
#include "packing/cells/cell_drainage_surfaces.h"

namespace aerate {

// A window keeps so far from where the flat part of a face ends, mm, or the share of its radius by which
// openings keep apart, whichever is less.
inline constexpr double kWindowMargin = 0.15;

// How far a window's tube reaches beyond the wall's faces, mm, or a quarter of the gap.
inline constexpr double kWindowInset = 0.25;

// A place for a round opening through the wall between two voids of neighbouring cells. The tube's ends lie
// in the voids; `wall` is its axis from face to face.
struct CellWindow {
  Channel channel;
  Segment wall;
  Passage passage;
};

// Places for windows of `radius` between any two voids (indices into cells.voids, the lower one first): for
// each pair up to six, apart from each other, the lowest and the highest along `limits.roof.up` and one in
// the middle first. Each lies with a margin in the flat part of both faces, exactly; keeps the wall from the
// model's surface, and the gap from other voids. `hollows` by void. In order of pairs.
std::vector<CellWindow> find_cell_windows(const CellVoids& cells, const std::vector<VoidHollows>& hollows,
                                          const PackingLimits& limits, double radius,
                                          const CellSurfaces& surfaces, Monitor& monitor);

}  // namespace aerate
