#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/drainage.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "packing/air/air_cups.h"
#include "packing/air/found_hollows.h"

// How a model drains, whoever hollowed it: found out from its surface alone.

namespace aerate {

struct DrainageQuestion {
  Vec3d up{0, 0, 1};       // the way in which the print grows
  double widest_hole = 7;  // what is wider belongs to the outside, mm
};

struct InspectedDrainage {
  double spacing =
      0;  // of the columns that it was found out on, mm: holes of less than three are not seen reliably
  FoundHollows found;  // without parts; in the model's coordinates
  TrappedPools pools;  // in hollows that are not sealed; `total`: their volume
  // What stays in recesses that belong to the outside, and are no less deep than columns are wide.
  double recesses_upright = 0, recesses_upside_down = 0;
  std::vector<AirCup> cups;  // that the print closes in while it grows, the widest first
};

// `model`: closed. Memory and time are bounded: of large models columns are wider. Throws InterruptedError.
InspectedDrainage inspect_drainage(const Mesh& model, const DrainageQuestion& question, Monitor& monitor);

// The cups alone, on columns about as wide as asked for.
std::vector<AirCup> cups_of(const Mesh& model, Vec3d up, double spacing);

}  // namespace aerate
