#include "core/overhang.h"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "core/error.h"

namespace aerate {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

Roof make_roof(const Overhang& overhang) {
  if (!(overhang.degrees > 0) || !(overhang.degrees < 90)) {
    throw UsageError(
        fmt::format("an overhang of {:g} degrees from the vertical makes no roof", overhang.degrees),
        "give an angle between 0 (walls must be upright) and 90 (ceilings may be flat); most "
        "printers manage 45");
  }
  if (!(overhang.bridge >= 0) || !std::isfinite(overhang.bridge)) {
    throw UsageError(fmt::format("a bridge of {:g} mm is no width", overhang.bridge),
                     "give the width of the widest flat ceiling that the printer spans, 0 mm or more");
  }
  const double extent = length(overhang.up);
  if (!(extent > 0) || !std::isfinite(extent)) {
    throw UsageError(fmt::format("the print direction ({:g}, {:g}, {:g}) points nowhere", overhang.up.x,
                                 overhang.up.y, overhang.up.z),
                     "give a direction such as +z or 0,0,1");
  }
  Roof roof;
  roof.up = overhang.up * (1 / extent);
  roof.sine = std::sin(overhang.degrees * kDegree);
  roof.cosine = std::cos(overhang.degrees * kDegree);
  roof.widest_ball = overhang.bridge / (2 * roof.cosine);
  return roof;
}

double largest_without_roof(const Roof& roof) {
  return std::floor(roof.widest_ball * 100) / 100;
}

double overhang_degrees(const Roof& roof) {
  return std::atan2(roof.sine, roof.cosine) / kDegree;
}

}  // namespace aerate
