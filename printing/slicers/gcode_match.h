#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "printing/slicers/bed.h"
#include "printing/slicers/gcode.h"
#include "printing/slicers/print_log.h"

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

// How far `a` is from `b`, if it looks like the same print at another place; nothing if it is at the same place, or of another
// size. The first layer does not count: what is printed round and before an object is on it.
std::optional<BedPlace> shift_of(const std::vector<ExtrusionMove>& a, const std::vector<ExtrusionMove>& b);

// O(length of all moves + area of the larger print). Prints beyond three metres or a hundred kilometres of
// lines count as different altogether.
PrintDifference compare_prints(const std::vector<ExtrusionMove>& a, const std::vector<ExtrusionMove>& b);

// Nothing if the prints are the same but for what varies from run to run, else what differs, in words.
std::optional<std::string> difference_of(const std::vector<ExtrusionMove>& a,
                                         const std::vector<ExtrusionMove>& b);

// The first command of `a` that `b` has not at its place, or the other way round, in words; nothing if each
// layer has the same in the same order. `a` is the G-code that is spoken of.
std::optional<std::string> difference_in_commands(const PrintLog& a, const PrintLog& b);

// The same for two prints of what should be the same model: its features, too, are printed alike (filament,
// speed, fan, acceleration, number of lines and
// seams), but for what varies from run to run.
std::optional<std::string> difference_of(const PrintLog& a, const PrintLog& b);

}  // namespace aerate
