#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/cells.h"
#include "core/drainage.h"
#include "core/packing.h"
#include "kernels/winding.h"
#include "packing/cells/cell_drainage_pools.h"
#include "packing/cells/cell_drainage_surfaces.h"

namespace aerate {

// A hole out of a void (index into cells.voids), and how liquid runs through it.
struct CellHole {
  EscapeHole hole;
  Passage passage;
};

// A tube that leads out of its void and to the surface, before it is known to be sound.
struct CellWayOut {
  EscapeHole hole;
  // Where the tube's side leaves the void: first and last along the axis from its start, mm; lowest and
  // highest along print orientation's up.
  double first = 0, last = 0, lowest = 0, highest = 0;
  double reached = 0;  // where along the axis that meets the surface

  // Once it was looked at: how much it shows, to 1; whether it is closed by the plate, comes out on the sides that were asked
  // for, and is sound (see WaysOut); the hole.
  std::optional<double> showing = std::nullopt;
  std::optional<bool> reaches_plate = std::nullopt, is_on_sides = std::nullopt, is_sound = std::nullopt;
  std::shared_ptr<const CellHole> made = nullptr;

  double length() const { return reached - first; }
};

// The sine of its angle with a direction along up.
double lean_of(Vec3d direction, Vec3d up);

// Tubes of one radius out of voids of any shape.
//
// A tube starts in its void, just before its side leaves it, and ends where its axis meets the model's
// surface. The whole side leaves the void's surface and the model's once, at 30 degrees or more, and in this
// order: a plane across the axis parts the two rims. It keeps the wall from the model's surface elsewhere,
// the gap from other voids, and leads out of every shell.
class WaysOut {
 public:
  // `outward`: see DrainableModel. `hollows`: by void.
  WaysOut(const std::vector<VoidHollows>& hollows, const PackingLimits& limits, double radius,
          const CellSurfaces& surfaces, const kernels::WindingView& outward);

  // No tube is longer, mm.
  double longest() const { return longest_; }
  double radius() const { return radius_; }

  // From a point in a void; nullopt if the void or the surface is not left as above.
  std::optional<CellWayOut> follow(std::uint32_t from, Vec3d inside, Vec3d direction) const;

  // The rest of what is said above.
  bool is_sound(const CellWayOut& way) const;

  // Height that liquid has to reach to leave, along the orientation's up.
  double sill_of(const CellWayOut& way, std::size_t orientation) const;
  CellHole hole_of(const CellWayOut& way) const;

 private:
  bool leave_void(const Tube& tube, CellWayOut& way) const;

  const std::vector<VoidHollows>& hollows_;
  PackingLimits limits_;
  double radius_, longest_;
  const CellSurfaces& surfaces_;
  kernels::WindingView outward_;
};

}  // namespace aerate
