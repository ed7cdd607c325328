#pragma once

#include "core/drainage.h"
#include "core/segment_distance.h"

namespace aerate {

// The axis of the prism by which a hole is cut.
inline Segment cut_of(const Tube& tube) {
  return {tube.start, tube.end + direction_of(tube) * (kCutBeyond * tube.radius)};
}

}  // namespace aerate
