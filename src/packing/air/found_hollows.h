#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "packing/air/air_columns.h"
#include "packing/air/air_nodes.h"
#include "packing/air/air_pools.h"

// Hollows of a model and the holes that lead out of them, found in its air. What a ball of a given width cannot come to from
// outside is a hollow if it is wider inside than where it opens, or deep behind narrow openings; else it is a corner, a
// groove or a hole that leads nowhere, and part of the outside.

namespace aerate {

struct FoundHole {
  Vec3d place{0, 0, 0};
  double width = 0;  // of a ball that just goes through
  std::uint32_t hollow = 0;
};

struct FoundHollow {
  double volume = 0;     // mm3
  Vec3d place{0, 0, 0};  // well inside
  bool is_sealed = false;
};

struct ThinWall {
  double thickness = 0;
  Vec3d place{0, 0, 0};  // on its inner side
};

struct FoundHollows {
  std::vector<FoundHollow> hollows;  // the largest first
  std::vector<FoundHole> holes;      // by hollow; the widest first
  std::vector<AirPart> parts;        // by span: what of it belongs to a hollow
  // The thinnest between a hollow and the outside, away from holes, whose rims are as thin as can be.
  std::optional<ThinWall> wall;
};

// `drained`: the flood of either orientation. `widest_hole`: of the ball's width, mm.
FoundHollows find_hollows(const AirColumns& columns, const AirNodes& nodes, const SurfaceIndex& surface,
                          const AirFlood& drained, double widest_hole);

}  // namespace aerate
