#pragma once

#include <cstddef>
#include <optional>

#include "check/ceilings.h"
#include "check/expected.h"
#include "core/mesh.h"
#include "core/monitor.h"
#include "packing/verify.h"

namespace aerate {

// What was read back from a file that holds the pieces of cells, and measured there. Lengths in mm.
struct PieceFacts {
  std::size_t triangle_count = 0;
  std::size_t piece_count = 0;
  double volume = 0;      // mm3
  double deviation = 0;   // see MeasuredCells
  Clearances clearances;  // see MeasuredCells
  std::size_t roof_count = 0;
  std::optional<Ceilings> ceilings;  // absent where they are not limited
  std::optional<double> kept_wall;   // see OutputFacts
};

// Checks pieces of cells without the model that they are voids of: `expected.solid` holds them alone, and the mesh
// that was read back is turned as they are, so that they face inward. Each triangle is the one that was meant, and
// all that check_cells says of sealed voids holds, as does the limit of their ceilings. Throws FailureError for the
// first that is not so; InterruptedError.
PieceFacts check_pieces(const Mesh& read_back, const Expected& expected, Monitor& monitor);

}  // namespace aerate
