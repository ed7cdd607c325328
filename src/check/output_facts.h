#pragma once

#include <cstddef>
#include <optional>

#include "check/ceilings.h"
#include "kernels/vec.h"
#include "packing/verify.h"

namespace aerate {

enum class OuterSurface { kept, remeshed };

// How voids were found to drain.
struct MeasuredDrainage {
  std::size_t sealed_cavities = 0;    // inner surfaces that no way joins to the outside
  std::size_t cavities_of_model = 0;  // inward shells that the model has itself, left as they are
  std::size_t cut_triangles = 0;      // of the model's, where holes come out; all others are as they were
  double channel_wall = 0;            // lower bound of what is between channels and the surface, mm
};

// What was read back from the written file, and measured there. Lengths in mm, volumes in mm3.
struct OutputFacts {
  std::size_t triangle_count = 0;
  std::size_t outer_triangle_count = 0;
  std::size_t void_triangle_count = 0;
  std::size_t void_count = 0;

  // What a slicer fills: without the voids (the outer surface alone) and with them.
  double volume_before = 0;
  double volume_after = 0;
  double volume_removed = 0;

  // Each void's radius is that of the ball round its planned centre that, with its roof, holds its vertices.
  double smallest_radius = 0;
  double largest_radius = 0;
  // Between those balls and the outer surface, and between each other: the real clearances are at least
  // these.
  Clearances clearances;
  // Largest depth by which a void stays inside its planned shape.
  double void_deviation = 0;

  // Voids that were given a roof, and the ceilings of all; absent where ceilings are not limited.
  std::size_t roof_count = 0;
  std::optional<Ceilings> ceilings;

  // Absent where each void is sealed.
  std::optional<MeasuredDrainage> drainage;

  // Between regions that stay solid and all that was taken out; absent where there are none.
  std::optional<double> kept_wall;

  // Absent where parts of the model overlap: the surface integral would count the overlap twice.
  std::optional<Vec3d> centre_of_mass_before;
  std::optional<Vec3d> centre_of_mass_after;
};

}  // namespace aerate
