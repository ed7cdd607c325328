#pragma once

#include <vector>

#include "packing/air/air_columns.h"

namespace aerate {

// Air that the layers below a height close in, but for the layer at that height.
struct AirCup {
  double area = 0;        // of the opening in that layer, mm2
  double volume = 0;      // closed in below it, mm3
  double height = 0;      // of that layer above the model's lowest point
  Vec3d place{0, 0, 0};   // the middle of the opening
  Vec3d bottom{0, 0, 0};  // the lowest place of what is closed in
};

// Every cup at the layer where its opening is widest, the widest first. Layers grow along +z. A cup that is less deep there
// than a column is wide is not told from a rough surface. What the build plate itself closes is taken for open: parts
// stand on supports.
std::vector<AirCup> cups_of(const AirColumns& columns);

}  // namespace aerate
