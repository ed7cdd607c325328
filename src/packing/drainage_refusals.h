#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "core/drainage.h"
#include "core/error.h"

// What is said where nothing can drain: the same for spheres and cells.

namespace aerate {

// What to try where holes are too wide, and where channels are: with them what has to become narrower too.
std::string narrower_holes(const DrainageRequest& request);
std::string narrower_channels();

// No network has two holes. `other_way`: what else the hint names, after a comma.
NothingToRemoveError nothing_is_opened(const DrainageRequest& request, const std::string& other_way = {});

// A hole that is asked for at a place cannot be made there. `usable`: the nearest place at which one can.
UsageError no_hole_leads_from(Vec3d place, const std::optional<Vec3d>& usable,
                              const DrainageRequest& request);

// Opens a hole at each place that is asked for. Throws the UsageErrors of `open` together, once all were tried.
void open_at_each(std::span<const Vec3d> places, const std::function<void(Vec3d place)>& open);

// All that was opened was left out again.
NothingToRemoveError all_stays_full(const DrainageRequest& request, const std::string& other_way = {});

}  // namespace aerate
