#pragma once

#include "packing/drainage_draft.h"

// While more than `kPoolsAimedAt` stays in a drainage.

namespace aerate {

// Opens the largest pools below.
Draft open_pools(DrainageTask& task, Draft draft);

// Voids at the foot of a branch stay full in print orientation, and upside down the tree, which was made for
// print orientation, may not lead from there to the high hole. Adds the channels that do, beside the tree,
// where that is worth it.
Draft add_channels_for_pools(DrainageTask& task, Draft draft);

// Leaves out the branches of which the largest share stays full; parts that are cut off by that get two holes
// of their own, or are left out too.
Draft leave_out_pools(DrainageTask& task, Draft draft);

}  // namespace aerate
