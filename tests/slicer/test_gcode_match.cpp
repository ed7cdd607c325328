#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
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
  EXPECT_EQ(difference_of(a, tower(11, 0)).value(), "1 layers are at other heights");
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

}  // namespace
}  // namespace aerate::test
