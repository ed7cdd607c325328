#include "pipeline/balance.h"

#include <fmt/format.h>

#include "core/upright.h"
#include "printing/footing.h"
#include "printing/strength.h"

namespace aerate {

Balance balance_of(const Mesh& outer, const OutputFacts& output, Vec3d up) {
  const UprightFrame frame(up);
  const Mesh turned = frame.is_the_models_own() ? Mesh{} : turned_upright(outer, frame);
  const Mesh& standing = frame.is_the_models_own() ? outer : turned;
  const auto margin = [&](const std::optional<Vec3d>& centre) -> std::optional<double> {
    if (!centre) return std::nullopt;
    return footing_margin(standing, frame.to_frame(*centre));
  };
  return {margin(output.centre_of_mass_before), margin(output.centre_of_mass_after),
          stiffness_upper_bound(output.volume_after / output.volume_before)};
}

void warn_of_tipping(const Balance& balance, const OutputFacts& output, Monitor& monitor) {
  if (!balance.tips_over()) return;
  const Vec3d centre = *output.centre_of_mass_after;
  monitor.notice(
      fmt::format("the model stood, and with these voids it tips over: its centre of mass, now at "
                  "({:.1f}, {:.1f}, {:.1f}) mm, "
                  "is {:.1f} mm outside of what it stands on",
                  centre.x, centre.y, centre.z, -*balance.margin_after));
}

}  // namespace aerate
