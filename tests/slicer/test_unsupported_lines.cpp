#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <string>

#include "bench/unsupported_lines.h"

// The length of lines with nothing below, where it can be worked out by hand.
namespace aerate::bench {
namespace {

// Along x at a height, from one place to another, extruding as much as it is long.
std::string line(double z, double y, double from, double to) {
  const auto text = [](double value) { return std::to_string(value); };
  return "G1 Z" + text(z) + " F600\nG1 X" + text(from) + " Y" + text(y) + "\nG1 X" + text(to) + " E" +
         text(std::abs(to - from)) + "\n";
}

std::string typed(const std::string& type, const std::string& lines, double height = 0.2) {
  return ";TYPE:" + type + "\n;WIDTH:0.4\n;HEIGHT:" + std::to_string(height) + "\n" + lines;
}

// Relative extrusion, and a layer on the bed.
std::string over(const std::string& lower, const std::string& upper) {
  return "M83\n" + typed("Perimeter", lower) + upper;
}

UnsupportedLength measured(const std::string& gcode, LineKind kind) {
  return unsupported_length(printed_lines(gcode)).at(static_cast<std::size_t>(kind));
}

TEST(UnsupportedLines, OnTheBedAllIsSupported) {
  const auto found = measured("M83\n" + typed("Internal infill", line(0.2, 0, 0, 10)), LineKind::sparse);
  EXPECT_DOUBLE_EQ(found.length, 10);
  EXPECT_EQ(found.unsupported, 0);
}

TEST(UnsupportedLines, ALineOverALineIsSupported) {
  const auto gcode = over(line(0.2, 0, 0, 10), typed("Internal infill", line(0.4, 0, 10, 0)));
  const auto found = measured(gcode, LineKind::sparse);
  EXPECT_NEAR(found.length, 10, 1e-9);
  EXPECT_NEAR(found.unsupported, 0, 1e-9);
}

TEST(UnsupportedLines, ALineOverNothingIsNot) {
  const auto gcode = over(line(0.2, 50, 0, 10), typed("Internal infill", line(0.4, 0, 0, 10)));
  const auto found = measured(gcode, LineKind::sparse);
  EXPECT_NEAR(found.unsupported, 10, 1e-9);
  EXPECT_NEAR(found.longest, 10, 1e-9);
}

TEST(UnsupportedLines, ALineHalfOverALine) {
  // The lower line ends at 5, round, and supports what is within both half widths of its end.
  const auto gcode = over(line(0.2, 0, 0, 5), typed("Solid infill", line(0.4, 0, 0, 10)));
  EXPECT_NEAR(measured(gcode, LineKind::solid).unsupported, 5 - 0.4, 1e-9);
}

TEST(UnsupportedLines, ALineBesideALineIsSupportedWhereTheyOverlap) {
  const auto beside = [](double y) {
    return measured(over(line(0.2, 0, -5, 15), typed("Internal infill", line(0.4, y, 0, 10))),
                    LineKind::sparse)
        .unsupported;
  };
  EXPECT_NEAR(beside(0.39), 0, 1e-9);
  EXPECT_NEAR(beside(0.41), 10, 1e-9);
}

TEST(UnsupportedLines, ALineAcrossTwoOthersBridgesTheGap) {
  // Lines along y at x = 2 and x = 8, each 0.4 wide.
  const auto across = [](double x) { return "G1 Z0.2\nG1 X" + std::to_string(x) + " Y-5\nG1 Y5 E10\n"; };
  const auto gcode = over(across(2) + across(8), typed("Bridge infill", line(0.4, 0, 2, 8), 0.4));
  const auto found = measured(gcode, LineKind::bridge);
  EXPECT_NEAR(found.length, 6, 1e-9);
  EXPECT_NEAR(found.unsupported, 6 - 2 * 0.4, 1e-9);
  EXPECT_NEAR(found.longest, 6 - 2 * 0.4, 1e-9);
}

TEST(UnsupportedLines, ASlantedLineAcrossALine) {
  // At 30 degrees: within 0.4 of the lower line for 0.4 / sin 30 on both sides.
  const double c = std::cos(std::numbers::pi / 6), s = std::sin(std::numbers::pi / 6);
  const std::string slanted = "G1 Z0.4\nG1 X" + std::to_string(-10 * c) + " Y" + std::to_string(-10 * s) +
                              "\nG1 X" + std::to_string(10 * c) + " Y" + std::to_string(10 * s) + " E20\n";
  const auto gcode = over(line(0.2, 0, -20, 20), typed("Internal infill", slanted));
  EXPECT_NEAR(measured(gcode, LineKind::sparse).unsupported, 20 - 2 * 0.4 / s, 1e-5);
}

TEST(UnsupportedLines, TheLongestWayGoesRoundCorners) {
  const std::string corner = "G1 Z0.4\nG1 X0 Y0\nG1 X3 E3\nG1 Y4 E4\nG1 X50 Y50\nG1 X55 E5\n";
  const auto found = measured(over(line(0.2, 99, 0, 10), typed("Internal infill", corner)), LineKind::sparse);
  EXPECT_NEAR(found.unsupported, 12, 1e-9);
  EXPECT_NEAR(found.longest, 7, 1e-9);
}

TEST(UnsupportedLines, OnlyTheLayerBelowCounts) {
  const auto gcode =
      over(line(0.2, 0, 0, 10) + line(0.4, 50, 0, 10), typed("Internal infill", line(0.6, 0, 0, 10)));
  EXPECT_NEAR(measured(gcode, LineKind::sparse).unsupported, 10, 1e-9);
}

TEST(UnsupportedLines, AThickLineRestsWhereItBegins) {
  // Infill of every second layer is twice as high, and rests on the layer before the last one.
  const std::string lower = line(0.2, 0, 0, 10) + line(0.4, 50, 0, 10);
  EXPECT_NEAR(
      measured(over(lower, typed("Internal infill", line(0.6, 0, 0, 10), 0.4)), LineKind::sparse).unsupported,
      0, 1e-9);
  // The threads of a bridge are thick, but hang in one layer.
  EXPECT_NEAR(
      measured(over(lower, typed("Bridge infill", line(0.6, 0, 0, 10), 0.4)), LineKind::bridge).unsupported,
      10, 1e-9);
}

TEST(UnsupportedLines, AbsoluteExtrusionAndTravels) {
  // Neither travels nor retractions are lines.
  const std::string gcode =
      "M82\nG92 E0\n" + typed("Perimeter", "G1 Z0.2\nG1 X0 Y0\nG1 X10 E1\nG1 E0.5\n") +
      typed("Internal infill", "G1 Z0.4\nG1 X0 Y0\nG1 E1\nG1 X20 E3\nG92 E0\nG1 X30\nG1 X31 E0.1\n");
  const auto found = measured(gcode, LineKind::sparse);
  EXPECT_NEAR(found.length, 21, 1e-9);
  EXPECT_NEAR(found.unsupported, 21 - 10.4, 1e-9);
}

TEST(UnsupportedLines, LongLinesFarFromTheOrigin) {
  const auto gcode = over(line(0.2, -300, -250, 50), typed("Top solid infill", line(0.4, -300.1, -250, 250)));
  EXPECT_NEAR(measured(gcode, LineKind::solid).unsupported, 200 - std::sqrt(0.4 * 0.4 - 0.1 * 0.1), 1e-9);
}

}  // namespace
}  // namespace aerate::bench
