#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "printing/slicers/gcode.h"

namespace aerate::bench {

// What a line is printed for, by the slicer's ";TYPE:".
enum class LineKind { perimeter, sparse, solid, bridge, other };
inline constexpr std::array kLineKinds{LineKind::perimeter, LineKind::sparse, LineKind::solid,
                                       LineKind::bridge, LineKind::other};
const char* name_of(LineKind kind);

// An extrusion as PrusaSlicer describes it by ";TYPE:", ";WIDTH:" and ";HEIGHT:".
struct PrintedLine {
  ExtrusionMove move;
  double width = 0, height = 0;  // mm
  LineKind kind = LineKind::other;
};

// Extrusions in the order of the G-code, arcs as chords of at most a millimetre. O(bytes).
//   width, height: of lines before any is told, mm
std::vector<PrintedLine> printed_lines(std::string_view gcode, double width = 0.45, double height = 0.2);

struct UnsupportedLength {
  double length = 0;       // of all lines of a kind, mm
  double unsupported = 0;  // of that, with nothing below
  double longest = 0;      // way without anything below, along lines that go on from each other
};

// How much of the lines has nothing below it: no line of the layer below lies within half a line's width of its middle,
// both taken as wide as they are printed. The same as slicers ask of overhangs. The layer below is the
// highest that ends no higher than the line begins (a bridge begins a layer up, however thick its threads are); what begins
// on the bed is supported. Exact up to rounding. O(n) for lines that are spread evenly.
std::array<UnsupportedLength, kLineKinds.size()> unsupported_length(const std::vector<PrintedLine>& lines);

}  // namespace aerate::bench
