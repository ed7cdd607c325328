#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "printing/slicers/gcode.h"

namespace aerate {

// How far two prints of what should be the same model are from each other. PrusaSlicer does not give the same
// G-code twice: where a seam is and which line comes first vary from run to run, while every line is where it
// was. So filament is compared by place, not move by move: in each layer it is spread over a grid of cells.
struct PrintDifference {
  std::size_t layers_in_one = 0;  // layers, by height, that only one of them has
  double filament = 0;            // share of all filament that is in another place
  double worst_layer = 0;         // the same for the layer where it is the largest part
  double worst_z = 0;             // its height, mm
};

// The largest distance between the sides of two prints' outlines, mm.
double outline_distance(const std::vector<ExtrusionMove>& a, const std::vector<ExtrusionMove>& b);

// O(length of all moves + area of the prints).
PrintDifference compare_prints(const std::vector<ExtrusionMove>& a, const std::vector<ExtrusionMove>& b);

// Nothing if the prints are the same but for what varies from run to run, else what differs, in words.
std::optional<std::string> difference_of(const std::vector<ExtrusionMove>& a,
                                         const std::vector<ExtrusionMove>& b);

}  // namespace aerate
