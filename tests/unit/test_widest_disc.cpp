#include <cmath>
#include <gtest/gtest.h>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "core/ceiling.h"

// The largest disc within figures whose answer is known.
namespace aerate {
namespace {

constexpr double kPrecision = 1e-3;

using Corners = std::vector<PointFromAbove>;

Ceiling within(std::initializer_list<Corners> polygons) {
  Ceiling ceiling;
  for (const Corners& corners : polygons)
    for (std::size_t i = 0; i < corners.size(); ++i)
      ceiling.rim.emplace_back(corners[i], corners[(i + 1) % corners.size()]);
  return ceiling;
}

Corners box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

Corners circle(double radius, double x, double y) {
  constexpr int kCorners = 720;
  Corners corners;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * std::numbers::pi * i / kCorners;
    corners.push_back({x + radius * std::cos(angle), y + radius * std::sin(angle)});
  }
  return corners;
}

TEST(WidestDisc, OfASquareIsItsSideHoweverItLies) {
  EXPECT_NEAR(widest_disc(within({box(-3, 5, 4, 12)}), 0), 7, kPrecision);
  for (const double angle : {0.1, 0.5, std::numbers::pi / 4}) {
    Corners turned;
    for (const auto& [x, y] : box(0, 0, 7, 7))
      turned.push_back(
          {x * std::cos(angle) - y * std::sin(angle), x * std::sin(angle) + y * std::cos(angle)});
    EXPECT_NEAR(widest_disc(within({turned}), 0), 7, kPrecision) << angle;
  }
}

TEST(WidestDisc, OfAStripIsItsWidthHoweverLongItIs) {
  for (const double length : {3.0, 30.0, 3000.0})
    EXPECT_NEAR(widest_disc(within({box(1, 1, 1 + length, 3)}), 0), 2, kPrecision) << length;
}

TEST(WidestDisc, OfAnLTouchesTheInnerCornerAndBothOuterSides) {
  // Legs as wide as w: from the centre (r, r) it is r to the corner (w, w).
  const double w = 4;
  const Ceiling figure = within({{{0, 0}, {20, 0}, {20, w}, {w, w}, {w, 20}, {0, 20}}});
  const double radius = w * std::numbers::sqrt2 / (1 + std::numbers::sqrt2);
  EXPECT_NEAR(widest_disc(figure, 0), 2 * radius, kPrecision);
}

TEST(WidestDisc, OfARingIsAsWideAsTheRing) {
  EXPECT_NEAR(widest_disc(within({circle(10, 1, 2), circle(7, 1, 2)}), 0), 3, 2 * kPrecision);
  // Where the hole is off the middle, as wide as the ring is at most.
  EXPECT_NEAR(widest_disc(within({circle(10, 1, 2), circle(7, 2, 2)}), 0), 4, 2 * kPrecision);
  EXPECT_NEAR(widest_disc(within({circle(10, 1, 2)}), 0), 20, 2 * kPrecision);
}

TEST(WidestDisc, OfATriangleIsItsInscribedCircle) {
  EXPECT_NEAR(widest_disc(within({{{0, 0}, {3, 0}, {0, 4}}}), 0), 2, kPrecision);
}

TEST(WidestDisc, IsWhatIsKnownWhereNoneIsWider) {
  const Ceiling figure = within({box(0, 0, 30, 5)});
  EXPECT_EQ(widest_disc(figure, 6), 6);
  EXPECT_EQ(widest_disc(figure, 5), 5);
  EXPECT_NEAR(widest_disc(figure, 4.9), 5, kPrecision);
  EXPECT_EQ(widest_disc(Ceiling{}, 0), 0);
  EXPECT_EQ(widest_disc(within({box(0, 0, 30, 0)}), 0), 0);
}

}  // namespace
}  // namespace aerate
