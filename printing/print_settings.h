#pragma once

namespace aerate {

// What lines of sparse infill are like: waves take less filament than the share of the space that they stand
// for.
enum class InfillPattern { gyroid, lines };

// Whose rules say what is solid inside: those of PrusaSlicer up to 2.5, or from 2.6 on.
enum class SolidRules { prusa_2_5, prusa_2_6 };

// Where layers are solid along walls that lean ("ensure vertical shell thickness"); of the rules from 2.6 on.
enum class VerticalShells {
  enabled,  // wherever walls or skins of the layers above and below leave infill thinner than the solid layers
  partial,   // where surfaces look up or down alone
  disabled,  // there too, as long as the shell is part of that of the layer before
};

// How lines along contours are laid where they do not fit.
enum class WallGenerator {
  arachne,  // they are printed wider
  classic,  // they are left out, and gaps filled
};

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
  SolidRules rules = SolidRules::prusa_2_5;
  VerticalShells vertical_shells = VerticalShells::enabled;
  WallGenerator walls = WallGenerator::arachne;
};

}  // namespace aerate
