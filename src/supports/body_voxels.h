#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/monitor.h"
#include "core/surface_index.h"
#include "supports/body_shape.h"
#include "supports/undersides.h"

namespace aerate {

// Smaller pieces are crumbs, mm3.
inline constexpr double kCrumb = 2;

// Where something is carried, mm: from its ceiling to what is below.
struct CarriedPlace {
  double x, y;
  double ceiling, floor;
};

// Whether a body stands on the model there.
//   z: height of what is lowest in it at a column
bool stands_on_model(const Undersides& columns, std::size_t column, double z, double clearance);

// Supports without their teeth as voxels: coordinates in columns, and in layers as high as a column is wide, from the plate up; the
// lowest layer first. What would tip over, or end above a slope on which it cannot stand, is drawn in less, body by body.
//   model: that `columns` are of
//   reach: how far beside what is held something may be, mm
std::vector<std::array<int, 3>> body_voxels(const Undersides& columns, const SurfaceIndex& model,
                                            const std::vector<CarriedPlace>& carried, const BodyShape& shape,
                                            double reach, Monitor& monitor);

}  // namespace aerate
