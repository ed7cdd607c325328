#pragma once

#include <vector>

#include "core/mesh.h"
#include "tests/support/blocks.h"

namespace aerate::test {

// Where a square hole of 4 mm in a wall is.
enum class BoxHole { bottom, top, side_low, side_middle };

// A box of 34 x 34 x 34 mm from the origin, with walls of 2 mm round a hollow of 30 mm, and holes: in the middle of the bottom
// and the top, and in the wall at x = 0, from 2 to 6 mm (level with the floor) or from 15 to 19 mm above the base.
inline Mesh hollow_box(const std::vector<BoxHole>& holes) {
  const std::vector<float> across{0, 2, 15, 19, 32, 34};
  const std::vector<float> up{0, 2, 6, 15, 19, 32, 34};
  return make_blocks({across, across, up}, [&](int x, int y, int z) {
    const bool is_hollow = x > 0 && x < 4 && y > 0 && y < 4 && z > 0 && z < 5;
    if (is_hollow) return false;
    for (const BoxHole hole : holes) {
      const bool is_middle = x == 2 && y == 2;
      if (hole == BoxHole::bottom && is_middle && z == 0) return false;
      if (hole == BoxHole::top && is_middle && z == 5) return false;
      if (hole == BoxHole::side_low && x == 0 && y == 2 && z == 1) return false;
      if (hole == BoxHole::side_middle && x == 0 && y == 2 && z == 3) return false;
    }
    return true;
  });
}

inline constexpr double kHollowOfBox = 30.0 * 30 * 30;

}  // namespace aerate::test
