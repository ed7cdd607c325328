#include "printing/cells/tube_section.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aerate {
namespace {

// Angles about the axis from the side of a tube that faces up: beyond the first its side leans no further than the
// overhang angle, up to the second the printer bridges it.
struct TopAngles {
  double ceiling = 0;
  double bridged = 0;
};

TopAngles top_angles(const Tube& tube, const Roof& roof) {
  TopAngles angles;
  if (!roof.limits_ceilings()) return angles;
  const double width = ceiling_width(tube, roof);
  const auto at_width = [&](double wide) { return std::asin(std::min(1.0, wide / (2 * tube.radius))); };
  angles.ceiling = at_width(width);
  angles.bridged = at_width(std::min(width, roof.bridge()));
  return angles;
}

// From the one to just before the other, no farther apart than `step`; `turn` moves those between.
void add_arc(std::vector<double>& angles, double from, double to, double step, double turn) {
  const double count = std::max(1.0, std::ceil((to - from) / step));
  const double shift = turn - std::floor(turn);
  angles.push_back(from);
  for (int i = shift > 0 ? 0 : 1; i < static_cast<int>(count); ++i)
    angles.push_back(from + (i + shift) * (to - from) / count);
}

}  // namespace

std::vector<Vec3d> tube_section(const Tube& tube, const Roof& roof, std::size_t sides, double turn) {
  constexpr double kFullTurn = 2 * std::numbers::pi;
  const double step = kFullTurn / static_cast<double>(sides);
  const TopAngles top = top_angles(tube, roof);
  std::vector<double> angles;
  if (top.ceiling == 0) {
    for (std::size_t i = 0; i < sides; ++i) angles.push_back((static_cast<double>(i) + turn) * step);
  } else {
    // A little less of the top for each turn.
    constexpr double kLess = 0.02;
    const double bridged = top.bridged * (1 - kLess * turn);
    add_arc(angles, -bridged, bridged, step, 0);
    // The chord from there that leans as far as the side where the ceiling ends.
    const double below = 2 * top.ceiling - bridged;
    if (below > bridged) angles.push_back(bridged);
    add_arc(angles, below, kFullTurn - below, step, turn);
    if (below > bridged) angles.push_back(kFullTurn - below);
  }
  const TubeFrame frame = frame_of(tube, roof.up);
  std::vector<Vec3d> ring;
  ring.reserve(angles.size());
  for (const double angle : angles)
    ring.push_back(tube.start - frame.down * (tube.radius * std::cos(angle)) -
                   frame.across * (tube.radius * std::sin(angle)));
  return ring;
}

}  // namespace aerate
