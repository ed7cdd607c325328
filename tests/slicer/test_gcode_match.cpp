#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <optional>
#include <string>
#include <vector>

#include "printing/slicers/gcode_match.h"

namespace aerate::test {
namespace {

using Moves = std::vector<ExtrusionMove>;

constexpr double kPerMillimetre = 0.03;  // filament

void add_line(Moves& moves, double from_x, double from_y, double x, double y, double z) {
  moves.push_back({from_x, from_y, x, y, z, kPerMillimetre * std::hypot(x - from_x, y - from_y)});
}

// A round tower of `layers`, each a loop of 80 corners that begins at corner `seam`, and some lines across.
Moves tower(int layers, int seam, double radius = 12) {
  constexpr int kCorners = 80;
  Moves moves;
  for (int layer = 0; layer < layers; ++layer) {
    const double z = 0.2 + 0.2 * layer;
    const auto corner = [&](int i) {
      const double angle = 2 * 3.14159265358979 * (i % kCorners) / kCorners;
      return std::pair(100 + radius * std::cos(angle), 90 + radius * std::sin(angle));
    };
    for (int i = 0; i < kCorners; ++i) {
      const auto [x0, y0] = corner(seam + i);
      const auto [x1, y1] = corner(seam + i + 1);
      add_line(moves, x0, y0, x1, y1, z);
    }
    for (double x = 92; x <= 108; x += 2) add_line(moves, x, 84, x, 96, z);
  }
  return moves;
}

Moves moved(Moves moves, double dx) {
  for (ExtrusionMove& move : moves) {
    move.x += dx;
    move.from_x += dx;
  }
  return moves;
}

TEST(GcodeMatch, ThePlaceOfTheSamePrintIsFound) {
  const Moves a = tower(10, 0);
  Moves b = moved(tower(10, 37), -12.5);
  // A line in the first layer that stays where it is, as those before a print do.
  Moves begun = a;
  for (Moves* print : {&begun, &b}) add_line(*print, 0, 0, 60, 0, 0.2);
  const auto shift = shift_of(begun, b);
  ASSERT_TRUE(shift.has_value());
  EXPECT_NEAR(shift->x, 12.5, 1e-9);
  EXPECT_NEAR(shift->y, 0, 1e-9);
  EXPECT_FALSE(shift_of(a, tower(10, 37)).has_value());
  EXPECT_FALSE(shift_of(a, moved(tower(10, 0, 12.1), 5)).has_value());  // of another size
  EXPECT_FALSE(shift_of(a, {}).has_value());
  EXPECT_FALSE(shift_of({}, {}).has_value());
}

TEST(GcodeMatch, SeamsAndOrderDoNotMatter) {
  const Moves a = tower(10, 0);
  EXPECT_FALSE(difference_of(a, a).has_value());
  Moves b = tower(10, 37);
  EXPECT_FALSE(difference_of(a, b).has_value());
  // The lines of a layer in another order, and one of them the other way round.
  std::reverse(b.begin(), b.begin() + 89);
  std::swap(b[0].from_y, b[0].y);
  EXPECT_FALSE(difference_of(a, b).has_value());
  EXPECT_LT(compare_prints(a, b).filament, 1e-9);
  // A seam in the middle of a line.
  Moves split = a;
  const ExtrusionMove line = split[85];
  split[85].y = 91;
  split[85].filament = kPerMillimetre * 7;
  split.push_back({line.x, 91, line.x, line.y, line.z, kPerMillimetre * 5});
  EXPECT_FALSE(difference_of(a, split).has_value());
}

TEST(GcodeMatch, RoundingDoesNotMatter) {
  Moves b = tower(10, 0);
  for (std::size_t i = 0; i < b.size(); ++i) b[i].x += i % 2 == 0 ? 0.0005 : -0.0005;
  EXPECT_FALSE(difference_of(tower(10, 0), b).has_value());
}

TEST(GcodeMatch, AnotherPlaceSizeOrHeightIsADifference) {
  const Moves a = tower(10, 0);
  EXPECT_EQ(difference_of(a, moved(a, 2.5)).value(), "its outline is 2.50 mm off");
  EXPECT_TRUE(difference_of(a, moved(a, 0.03)).has_value());
  EXPECT_TRUE(difference_of(a, tower(10, 0, 12.05)).has_value());
  EXPECT_EQ(difference_of(a, tower(11, 0)).value(), "1 layer is at another height");
  EXPECT_TRUE(difference_of(a, {}).has_value());
}

TEST(GcodeMatch, WhatDiffersWithinTheSameOutlineIsFound) {
  const Moves a = tower(10, 0);
  // Lines of the infill moved in one layer; less of it in all.
  Moves b = a;
  for (std::size_t i = 80; i < 89; ++i) {
    b[i].x += 0.5;
    b[i].from_x += 0.5;
  }
  EXPECT_TRUE(difference_of(a, b).value().ends_with("at z = 0.20 mm"));
  EXPECT_GT(compare_prints(a, b).worst_layer, 0.2);
  b = a;
  for (ExtrusionMove& move : b) move.filament *= 0.99;
  EXPECT_TRUE(difference_of(a, b).has_value());
}

TEST(GcodeMatch, MovesThatNoPrinterReachesTakeNoMemory) {
  Moves a = tower(1, 0);
  add_line(a, 0, 0, 1e12, 1e12, 0.2);
  EXPECT_TRUE(difference_of(a, a).value().find("more than can be compared") != std::string::npos);
}

TEST(GcodeMatch, AMillionLargeLayersAreQuick) {
  Moves moves;
  for (int i = 0; i < 1'000'000; ++i) {
    const double z = 0.01 * i, x = i % 2 == 0 ? 0 : 2900;
    moves.push_back({x, x, x + 1, x, z, 1});
  }
  EXPECT_FALSE(difference_of(moves, moves).has_value());
  // More than can be compared is different, not endless.
  moves.assign(100'000, {0, 0, 2900, 2900, 0.2, 1});
  EXPECT_DOUBLE_EQ(compare_prints(moves, moves).filament, 1);
  EXPECT_TRUE(difference_of(moves, moves).value().find("longer than") != std::string::npos);
}

// Three layers of two features, with what a slicer puts between them.
std::string print_with(const std::string& after_second_layer, const std::string& speed = "F1200",
                       const std::string& in_second_layer = "", const std::string& start = "M104 S200\n") {
  std::string gcode = start + "M83\nM107\n";
  for (int layer = 1; layer <= 3; ++layer) {
    gcode += "G1 Z0." + std::to_string(2 * layer) + " F7800\nG92 E0\n";
    if (layer == 2) gcode += in_second_layer;
    gcode += ";TYPE:Perimeter\nG1 " + (layer == 2 ? speed : "F1200") +
             "\nG1 X10 Y0 E1\nG1 X10 Y10 E1\nG1 X0 Y10 E1\nG1 X0 Y0 E1\n"
             ";TYPE:Internal infill\nG1 F2400\nG1 X2 Y2\nG1 X8 Y8 E2\n";
    if (layer == 2) gcode += after_second_layer;
  }
  return gcode + "M104 S0\nM84 ; motors off\n";
}

std::optional<std::string> difference(const std::string& a, const std::string& b) {
  return difference_of(log_of_print(a), log_of_print(b));
}

TEST(GcodeMatch, WhateverIsNoMoveIsMissed) {
  const std::string plain = print_with("");
  EXPECT_FALSE(difference(plain, plain).has_value());
  for (const char* line : {"M600",
                           "M601",
                           "M0",
                           "M25",
                           "T1",
                           "M104 S230",
                           "M109 S230",
                           "M140 S60",
                           "M220 S50",
                           "M221 S95",
                           "M117 put the magnets in",
                           "M190 S60",
                           "PAUSE",
                           "@pause",
                           "G4 P1000",
                           "M106 P1 S9",
                           "EXCLUDE_OBJECT_START NAME=a",
                           "M486 S1",
                           "; printing object a id:0 copy 0",
                           "G92 X50 Y50",
                           "G92",
                           "M204 R100",
                           "G0 X5 Y195 F9000",
                           "G1 X-30 F6000",
                           "G1 Z60 F600"}) {
    const std::string with = print_with(std::string(line) + "\n");
    const auto lost = difference(with, plain);
    ASSERT_TRUE(lost.has_value()) << line;
    EXPECT_TRUE(lost->find("after the layer at z = 0.40 mm, would be lost") != std::string::npos) << *lost;
    EXPECT_TRUE(lost->find(line) != std::string::npos) << *lost;
    EXPECT_TRUE(difference(plain, with).value().find("is not in it") != std::string::npos) << line;
    EXPECT_FALSE(difference(with, with).has_value()) << line;
  }
  EXPECT_EQ(difference(print_with("M600\n"), plain).value(),
            "line 28 of it, \"M600\" after the layer at z = 0.40 mm, would be lost");
  // Another text, another order, another layer.
  EXPECT_TRUE(difference(print_with("M117 block\n"), print_with("M117 model\n")).has_value());
  EXPECT_TRUE(difference(print_with("M0\nM25\n"), print_with("M25\nM0\n")).has_value());
  EXPECT_TRUE(difference(print_with("M600\n"), print_with("", "F1200", "M600\n")).has_value());
  EXPECT_TRUE(difference(plain, print_with("", "F1200", "", "M104 S215\n")).has_value());
}

TEST(GcodeMatch, FilamentThroughTheStandingNozzleIsMissed) {
  const std::string plain = print_with("");
  EXPECT_EQ(
      difference(print_with("G1 E25 F200\n"), plain).value(),
      "0.0 mm of filament goes through the standing nozzle instead of 25.0 after the layer at z = 0.40 mm");
  EXPECT_TRUE(difference(plain, print_with("G1 E25 F200\n")).has_value());
  EXPECT_TRUE(difference(print_with("G1 E10\nG1 E10\nG1 E5\n"), plain).value().find("of 25.0") !=
              std::string::npos);
  EXPECT_TRUE(
      difference(print_with("G1 E-30 F900\n"), plain).value().find("stays retracted instead of 30.0") !=
      std::string::npos);
  // What is retracted and given back, on the spot or along a wipe, with a little more or less.
  for (const char* retraction : {"G1 E-5\nG1 E5\n", "G1 E-1\nG1 X3 Y3 E-4\nG1 X1 Y1\nG1 E5\n",
                                 "G1 E-5\nG1 E5.2\n", "G1 E-5\nG1 E4.8\n"})
    EXPECT_FALSE(difference(print_with(retraction), plain).has_value()) << retraction;
}

TEST(GcodeMatch, TravelsWithinThePrintAreTheSlicers) {
  const std::string plain = print_with("");
  for (const char* travel : {"G1 X3 Y3 F7800\n", "G1 X-3 Y13 F7800\n", "G1 Z2 F7800\nG1 X3\nG1 Z.6\n"})
    EXPECT_FALSE(difference(print_with(travel + std::string("G1 X8 Y8\n")), plain).has_value()) << travel;
  // By G91 they are none of the slicer's, wherever they lead.
  EXPECT_TRUE(difference(print_with("G91\nG1 X1\nG90\nM83\n"), print_with("G91\nG90\nM83\n")).has_value());
}

TEST(GcodeMatch, AccelerationsOfTravelsAreMissed) {
  EXPECT_EQ(difference(print_with("M204 T100\n"), print_with("")).value(),
            "line 28 of it, \"M204 T100\" would be lost");
  EXPECT_TRUE(difference(print_with("M204 S50 T100\n"), print_with("M204 S50\n")).has_value());
  // The slicer writes them where the travels are, here a layer sooner.
  const std::string late = print_with("M204 T100\n"), soon = print_with("", "F1200", "M204 T100\n");
  EXPECT_FALSE(difference(late, soon).has_value());
}

TEST(GcodeMatch, RepetierSetsAccelerationsByM201) {
  const std::string repetier = "; gcode_flavor = repetier\n", marlin = "; gcode_flavor = marlin\n";
  const auto with = [](const char* lines, const std::string& flavor) { return print_with(lines) + flavor; };
  const char *once = "M201 X500 Y500\n", *twice = "M201 X900 Y900\nM201 X500 Y500\n";
  EXPECT_FALSE(difference(with(once, repetier), with(twice, repetier)).has_value());
  EXPECT_TRUE(difference(with(once, repetier), with("M201 X900 Y900\n", repetier)).has_value());
  EXPECT_TRUE(difference(with("M202 X900 Y900\n", repetier), with("", repetier)).has_value());
  // Elsewhere it is a limit of the machine.
  EXPECT_TRUE(difference(with(once, marlin), with(twice, marlin)).has_value());
}

TEST(GcodeMatch, CommentsRetractionsAndPositionsAreNoCommands) {
  EXPECT_FALSE(
      difference(print_with("G92 E0\nG10 ; retract\nG11\n; a comment\n"), print_with("")).has_value());
  EXPECT_FALSE(difference(print_with("M601 ; now\n"), print_with("M601\n")).has_value());
  // Progress follows the times, which are compared; but a print has it or has it not.
  EXPECT_FALSE(difference(print_with("M73 P31 R8\n"), print_with("M73 P32 R8\n")).has_value());
  EXPECT_TRUE(difference(print_with("M73 P31 R8\n"), print_with("")).has_value());
}

TEST(GcodeMatch, SpeedFanAndAccelerationOfAFeatureAreCompared) {
  const std::string plain = print_with("");
  EXPECT_FALSE(difference(plain, print_with("", "F1190")).has_value());
  EXPECT_EQ(difference(plain, print_with("", "F600")).value(),
            "at z = 0.40 mm the feature \"Perimeter\" is printed at 10.0 mm/s instead of 20.0");
  // As settings of a few layers make it.
  EXPECT_EQ(difference(plain, print_with("", "F960")).value(),
            "at z = 0.40 mm the feature \"Perimeter\" is printed at 16.0 mm/s instead of 20.0");
  EXPECT_TRUE(difference(plain, print_with("", "F1070")).has_value());
  EXPECT_FALSE(difference(plain, print_with("", "F1110")).has_value());
  // Infill is slowed down for cooling more or less, but not in all.
  const std::string slow_infill =
      std::string(plain).replace(plain.rfind("F2400"), std::string("F2400").size(), "F1920");
  EXPECT_TRUE(difference(plain, slow_infill).value().find("minutes instead of") != std::string::npos);
  // Slicers say the fan again or a layer later, but not another speed.
  EXPECT_FALSE(difference(print_with("M106 S100\n"), print_with("M106 S102.55\nM106 S102.55\n")).has_value());
  EXPECT_TRUE(difference(print_with("M106 S100\n"), plain).value().find("fan at 0 of 255 instead of 100") !=
              std::string::npos);
  EXPECT_FALSE(difference(print_with("M204 S500\n"), print_with("M204 S900\nM204 S500\n")).has_value());
  EXPECT_TRUE(difference(print_with("M204 S500\n"), print_with("M204 S900\n")).has_value());
}

}  // namespace
}  // namespace aerate::test
