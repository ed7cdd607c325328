#include "packing/drainage_refusals.h"

#include <fmt/format.h>
#include <vector>

namespace aerate {
namespace {

std::string more_sides(const DrainageRequest& request) {
  return request.sides.is_anywhere() ? "" : "allow more sides with --holes-on and --holes-not-on, ";
}

}  // namespace

std::string narrower_holes(const DrainageRequest& request) {
  if (request.hole_radius > request.channel_radius)
    return fmt::format("a smaller --hole-diameter ({:g} mm or more, as wide as channels)",
                       2 * request.channel_radius);
  return narrower_channels();
}

std::string narrower_channels() {
  return "a smaller --channel-diameter and --hole-diameter (holes are no narrower than channels)";
}

UsageError no_hole_leads_from(Vec3d place, const std::optional<Vec3d>& usable,
                              const DrainageRequest& request) {
  const std::string what = fmt::format(
      "no straight hole leads from ({:f}, {:f}, {:f}) mm to a void that drains", place.x, place.y, place.z);
  if (usable)
    return UsageError(what,
                      fmt::format("the nearest place from which one does is ({:.2f}, {:.2f}, {:.2f}) mm; "
                                  "or leave --escape-hole out",
                                  usable->x, usable->y, usable->z));
  return UsageError(what, "ask for a place nearer to a large void, give " + narrower_holes(request) +
                              ", or leave --escape-hole out");
}

void open_at_each(std::span<const Vec3d> places, const std::function<void(Vec3d place)>& open) {
  std::vector<UsageError> refusals;
  for (const Vec3d place : places) {
    try {
      open(place);
    } catch (const UsageError& refusal) {
      refusals.push_back(refusal);
    }
  }
  if (refusals.empty()) return;
  if (refusals.size() == 1) throw refusals.front();
  std::string what = fmt::format("{} of {} escape holes cannot be made where they are asked for",
                                 refusals.size(), places.size());
  for (const UsageError& refusal : refusals) what += fmt::format("\n{}: {}", refusal.what(), refusal.hint());
  throw UsageError(what, "give other places with --escape-hole");
}

NothingToRemoveError nothing_is_opened(const DrainageRequest& request, const std::string& other_way) {
  return NothingToRemoveError(
      fmt::format("no place was found for two escape holes of {:g} mm, so no void can drain",
                  2 * request.hole_radius),
      request.escape_holes.empty() ? more_sides(request) + ("give " + narrower_holes(request)) +
                                         ", larger voids, or places with --escape-hole" + other_way
                                   : "ask for other places, or leave --escape-hole out");
}

NothingToRemoveError all_stays_full(const DrainageRequest& request, const std::string& other_way) {
  return NothingToRemoveError(
      fmt::format("more than {:g} % of every group of voids would stay full, in print orientation and upside "
                  "down",
                  100 * kPoolsAimedAt),
      more_sides(request) + "give other places with --escape-hole, " + narrower_holes(request) +
          ", or larger voids" + other_way);
}

}  // namespace aerate
