#include <gtest/gtest.h>

#include "printing/footing.h"
#include "tests/support/shapes.h"

namespace aerate::test {
namespace {

TEST(Footing, MeasuresToTheNearestEdgeOfWhatStandsOnTheGround) {
  const Mesh box = make_box({0, 0, 5}, {30, 20, 50});
  EXPECT_NEAR(footing_margin(box, {15, 10, 20}).value(), 10, 1e-9);
  EXPECT_NEAR(footing_margin(box, {27, 10, 20}).value(), 3, 1e-9);
  EXPECT_NEAR(footing_margin(box, {32, 10, 20}).value(), -2, 1e-9);
}

TEST(Footing, SpansTheGroundBetweenFeet) {
  const Mesh feet = join(make_box({0, 0, 0}, {2, 2, 10}), make_box({18, 0, 0}, {20, 2, 10}));
  const Mesh table = join(feet, join(make_box({0, 18, 0}, {20, 20, 10}), make_box({0, 0, 9}, {40, 20, 12})));
  EXPECT_NEAR(footing_margin(table, {10, 10, 5}).value(), 10, 1e-9);
  // What hangs over carries nothing.
  EXPECT_LT(footing_margin(table, {25, 10, 5}).value(), 0);
}

TEST(Footing, IsNothingForATipOrAnEdge) {
  Mesh tip;
  tip.positions = {{0, 0, 0}, {-5, -5, 10}, {5, -5, 10}, {0, 5, 10}};
  tip.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}};
  EXPECT_FALSE(footing_margin(tip, {0, 0, 7}).has_value());
  Mesh edge = tip;
  edge.positions = {{0, -5, 0}, {0, 5, 0}, {-5, 0, 10}, {5, 0, 10}};
  EXPECT_FALSE(footing_margin(edge, {0, 0, 7}).has_value());
}

}  // namespace
}  // namespace aerate::test
