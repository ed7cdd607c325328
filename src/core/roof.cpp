#include "core/roof.h"

#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"

namespace aerate {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::string to_text(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

}  // namespace

Roof make_roof(const Overhang& overhang) {
  if (!(overhang.degrees > 0) || !(overhang.degrees < 90)) {
    throw UsageError(
        "an overhang of " + to_text(overhang.degrees) + " degrees from the vertical makes no roof",
        "give an angle between 0 (walls must be upright) and 90 (ceilings may be flat); most "
        "printers manage 45");
  }
  if (!(overhang.bridge >= 0) || !std::isfinite(overhang.bridge)) {
    throw UsageError("a bridge of " + to_text(overhang.bridge) + " mm is no width",
                     "give the width of the widest flat ceiling that the printer spans, 0 mm or more");
  }
  const double extent = length(overhang.up);
  if (!(extent > 0) || !std::isfinite(extent)) {
    throw UsageError("the print direction (" + to_text(overhang.up.x) + ", " + to_text(overhang.up.y) + ", " +
                         to_text(overhang.up.z) + ") points nowhere",
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
