#include "packing/drainage_refusals.h"

#include <fmt/format.h>

namespace aerate {

NothingToRemoveError nothing_is_opened(const DrainageRequest& request) {
  return NothingToRemoveError(
      fmt::format("no place was found for two escape holes of {:g} mm, so no void can drain",
                  2 * request.hole_radius),
      request.escape_holes.empty()
          ? "give a smaller --hole-diameter, larger voids, or places with --escape-hole"
          : "ask for other places, or leave --escape-hole out");
}

NothingToRemoveError all_stays_full() {
  return NothingToRemoveError(
      fmt::format("more than {:g} % of every group of voids would stay full, in print orientation and upside "
                  "down",
                  100 * kPoolsAimedAt),
      "give other places with --escape-hole, a smaller --hole-diameter, or larger voids");
}

}  // namespace aerate
