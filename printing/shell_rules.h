#pragma once

#include "printing/print_settings.h"

namespace aerate {

// Where a slicer puts walls, solid and sparse infill in a layer: the rules of PrusaSlicer 2.5 or of 2.6 to 2.9
// (PrintObject::discover_vertical_shells, LayerRegion::process_external_surfaces) and the values of its 0.2
// mm profiles, as lengths in mm for a print's settings. docs/economics.md explains them.
struct ShellRules {
  double spacing = 0;        // between lines that lie side by side
  double wall = 0;           // from the contour to the inner edge of the walls
  double round_edge = 0;     // of that stays empty along the contour, since the outer line's side is round
  double fill = 0;           // from the contour to where infill begins: it overlaps the walls
  double widened_walls = 0;  // infill narrower than this is left to the walls, which are printed wider
  double web_excess = 0;  // what walls that meet take more, as a share: lines between them do not fit exactly
  // Layers that look up or down lean if their contour moves by this much from one layer to the next.
  double lean = 0;
  double skin_margin = 0;  // what looks up or down is printed so much wider than it is, into the infill
  double unsupported = 0;  // but into a modifier of 0 % only so far as less than this of one is below it
  double shadow = 0;       // shadows of what looks up or down in the next layers are wider by this,
  double skin_shadow = 0;  // those of skins amid infill, skin margin and all, by this
  // Skins grow by no more than depths are known for, and before they do they cast their shadows.
  bool has_narrow_skins = false;
  bool walls_cover = true;  // a shell is also where walls of the layers above and below are
  int top_layers = 0;       // layers of a skin that looks up with its shadow, and of one that looks down:
  int bottom_layers = 0;    // as many as asked for, or as make up the least thickness of the profiles
  double least_shell = 0;   // shells inside of the walls that are narrower are left out
  double widening = 0;      // others reach this far into sparse infill
};
ShellRules shell_rules(const PrintSettings& settings);

// What is printed, by length of line and area, of the space that lines of sparse infill run through (0..1).
double printed_share(double infill, InfillPattern pattern);

// The share of the border of modifiers along which lines of sparse infill are joined that end there (0..1).
double border_share(double infill, const PrintSettings& settings);

// Lines of sparse infill are joined along this share of the edge that they end at (0..1): gyroid's less where they are dense,
// since the ways from one to the next are short.
double joined_share(double infill, InfillPattern pattern);

}  // namespace aerate
