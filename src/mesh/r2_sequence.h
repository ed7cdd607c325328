#pragma once

#include <cmath>
#include <cstddef>

namespace aerate {

struct UnitSquarePoint {
  double x, y;
};

// Point i of the R2 sequence: steps of 1/g and 1/g^2 with g the plastic number, g^3 = g + 1. It fills a square
// evenly in any direction, and never along the faces of a part, as a square raster would.
// (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.)
inline UnitSquarePoint r2_point(std::size_t i, double start) {
  constexpr double kStepX = 0.7548776662466927;
  constexpr double kStepY = 0.5698402909980532;
  const auto fraction = [](double value) { return value - std::floor(value); };
  return {fraction(start + kStepX * static_cast<double>(i)),
          fraction(start + kStepY * static_cast<double>(i))};
}

}  // namespace aerate
