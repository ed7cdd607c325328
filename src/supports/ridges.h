#pragma once

#include <cstdint>
#include <vector>

#include "supports/undersides.h"

// Narrow ridges under overhangs, as lines seen from above: under free edges, which they follow, and straight ones across the
// bridging direction.

namespace aerate {

// A place on a ridge's middle line, and the span that it is under.
struct RidgePoint {
  double x = 0, y = 0;  // mm
  std::uint32_t span = 0;
};

// One alone: a short ridge.
struct RidgeRun {
  std::vector<RidgePoint> points;
};

// Along what ends in the air: `edges`, spans of one overhang. Straight where these are nearly so, and broken at corners.
std::vector<RidgeRun> edge_ridges(const Undersides& undersides, const std::vector<std::uint32_t>& edges);

// Parallel ones, no farther apart than twice the reach, through an overhang's spans that are farther than `close` from what holds
// them: of many directions (edges' own among them) and phases that with the least length.
//   own: distances from what holds each span without ridges; with_edges: and with those under the edges, mm
std::vector<RidgeRun> parallel_ridges(const Undersides& undersides, const std::vector<std::uint32_t>& piece,
                                      const std::vector<RidgeRun>& edges, const std::vector<double>& own,
                                      const std::vector<double>& with_edges, double close, double reach);

}  // namespace aerate
