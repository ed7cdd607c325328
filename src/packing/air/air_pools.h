#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/drainage.h"
#include "packing/air/air_columns.h"

// Liquid at rest in the air of a model.

namespace aerate {

// By span, the height up to which liquid stands at most before it runs out: over all ways to the outside the least of
// the highest sill. Infinite where there is no way. Heights are against gravity in the orientation.
// A priority flood (R. Barnes, C. Lehman and D. Mulla, 2014).
struct AirFlood {
  std::vector<double> height;
  std::vector<std::uint32_t> towards;  // the span that it runs over into; kNone outside, or if there is none
};
AirFlood flood(const AirColumns& columns, std::size_t orientation);

// A part of a span, by heights along +z.
struct AirPart {
  double from = 0, to = 0;
};

// Both floods.
struct AirFloods {
  AirFlood upright, upside_down;
};

// Volumes that stay in parts of spans (one for each span; empty parts count for nothing), all of them full at first.
// `after_both` is an upper bound: where liquid can run several ways it is taken to part so that the most stays. `total` is
// the volume of all parts.
TrappedPools pools_in(const AirColumns& columns, const AirFloods& floods, const std::vector<AirPart>& parts);

// What liquid stays of a part, upright or upside down, mm3.
double left_in(const AirColumns& columns, const AirFlood& flood, std::size_t orientation, std::uint32_t span,
               const AirPart& part);

}  // namespace aerate
