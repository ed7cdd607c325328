#pragma once

#include <string>

#include "core/drainage.h"
#include "core/error.h"

// What is said where nothing can drain: the same for spheres and cells.

namespace aerate {

// No network has two holes.
NothingToRemoveError nothing_is_opened(const DrainageRequest& request);

// All that was opened was left out again.
NothingToRemoveError all_stays_full();

}  // namespace aerate
