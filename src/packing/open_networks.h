#pragma once

#include "packing/drainage_draft.h"

namespace aerate {

// The sets of voids that channels can join, numbered by falling volume; without the voids that are too narrow
// for one.
Draft find_networks(DrainageTask& task);

// Opens networks at the places that were asked for. Throws UsageError where no hole leads from there to a
// void.
Draft open_where_asked(DrainageTask& task, Draft draft);

// Opens the networks that are worth it below and above, and joins their voids by a tree; what cannot be
// opened or reached is left out. If two places or more were asked for, only networks that these open are
// worth it.
Draft open_and_join(DrainageTask& task, Draft draft);

}  // namespace aerate
