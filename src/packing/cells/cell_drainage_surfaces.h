#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/cells.h"
#include "core/packing.h"
#include "core/surface_index.h"
#include "packing/tube_clearance.h"

namespace aerate {

// Directions round a tube in which its side is looked at.
inline constexpr int kTubeSides = 12;

// Starts of lines on the side of a tube, in its plane of `at`; the first is the lowest.
std::vector<Vec3d> lines_round(Vec3d at, const Tube& tube, Vec3d up);

// The surfaces of all voids and of the model: where rays meet them, and what keeps clear of them.
class CellSurfaces {
 public:
  // No ray is longer than `longest`. The model's surface must outlive this, and so must `kept` (see DrainableModel).
  CellSurfaces(const SurfaceIndex& model, const CellVoids& cells, const PackingLimits& limits, double longest,
               const SurfaceIndex* kept = nullptr);
  CellSurfaces(const CellSurfaces&) = delete;
  CellSurfaces& operator=(const CellSurfaces&) = delete;

  const TubeClearance& model() const { return model_; }
  const TubeClearance& voids() const { return voids_; }

  // Is the axis, from end to end, farther than radius + gap from the surfaces of voids other than those two?
  bool keeps_gap(const Tube& tube, std::uint32_t from, std::uint32_t to) const;

 private:
  std::vector<std::uint32_t> first_;  // triangle of each void in the index; the count
  SurfaceIndex index_;
  double gap_;
  TubeClearance model_, voids_;
};

}  // namespace aerate
