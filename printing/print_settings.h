#pragma once

namespace aerate {

// What lines of sparse infill are like: waves take less filament than the share of the space that they stand
// for.
enum class InfillPattern { gyroid, lines };

// How a model is printed from filament, as slicers name it. Lengths in mm.
struct PrintSettings {
  double infill = 1.0;         // share of the inside that is printed, 0..1
  double modifier_infill = 0;  // the same where a modifier is
  InfillPattern pattern = InfillPattern::gyroid;
  int perimeters = 2;
  double line_width = 0.45;
  double layer_height = 0.2;
  int top_layers = 5;     // solid layers under a surface that looks up
  int bottom_layers = 4;  // and over one that looks down
};

}  // namespace aerate
