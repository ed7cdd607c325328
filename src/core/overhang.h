#pragma once

#include "kernels/roof.h"
#include "kernels/vec.h"

namespace aerate {

// What a printer makes without support.
struct Overhang {
  double degrees = 45;  // how far a wall may lean out, from the vertical; in (0, 90)
  double bridge = 5;    // width of the widest flat ceiling, mm; 0 or more
  Vec3d up{0, 0, 1};    // against gravity; of any length but 0
};

// The shape that voids take for it. The only sines and cosines of a packing are computed here, once, so that
// kernels need none. Throws UsageError for values outside their range.
Roof make_roof(const Overhang& overhang);

// The radius of the largest balls that need no roof, rounded down to 0.01 mm.
double largest_without_roof(const Roof& roof);

// The overhang angle of a roof, degrees from the vertical.
double overhang_degrees(const Roof& roof);

}  // namespace aerate
