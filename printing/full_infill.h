#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "printing/layer_slices.h"

namespace aerate {

// How far a region reaches beyond the centre of a pixel at its rim in the direction (x, y), a unit vector: mm.
using RimReach = std::function<double(std::size_t pixel, double x, double y)>;

// What lines of full infill print of the regions of a layer, as a share of their area. Slicers spread as many whole lines as fit evenly
// over each connected region, across its extent (Fill::_adjust_solid_spacing), and in infill that is full as its density says so, not
// as a solid layer is, lines get no wider by that.
//   pixels: not 0 in the regions; none in the first and last rows and columns
//   angle: across the lines
//   spacing: mm
double full_infill_share(const std::vector<std::uint8_t>& pixels, const LayerRaster& raster, double angle,
                         double spacing, const RimReach& reach);

}  // namespace aerate
